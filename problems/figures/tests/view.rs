//! Directions from which bodies are seen.

use figures::View;

#[test]
fn a_view_looks_at_the_face_with_its_normal() {
    let normals =
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for normal in normals {
        let towards = View::towards(normal.map(|part| 3.0 * part)).towards_viewer();
        let height: f64 = towards.iter().zip(normal).map(|(part, normal)| part * normal).sum();
        assert!(height > 0.3, "{normal:?}");
    }
    assert_eq!([0, 1].map(|face| View::towards(normals[face])), [View::default(); 2]);
    assert_ne!(View::towards(normals[5]), View::default());
    for none in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(View::towards(none), View::default());
    }
}
