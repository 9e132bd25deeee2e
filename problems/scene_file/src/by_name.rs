//! Paths of the short form in a scene with lists: `upper.material` is the material of the body with that name.

use crate::SceneFile;

/// Where a path of the short form leads to in a scene with lists; nowhere for other paths, and where no body has the
/// name.
pub(crate) fn places(file: &SceneFile, path: &str) -> Vec<String> {
    if file.parts().is_empty() {
        return Vec::new();
    }
    let parts = || file.parts().iter().enumerate();
    let named = |name: &str| parts().find(|(_, part)| part.name == name).map(|(index, _)| format!("body[{index}]"));
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let below = |place: String| if rest.is_empty() { place } else { format!("{place}.{rest}") };
    match (first, rest) {
        ("upper", "top") => named("upper").map(|body| format!("{body}.block.top.height")).into_iter().collect(),
        ("lower" | "upper", _) => named(first).map(below).into_iter().collect(),
        ("surface" | "admissible", _) => {
            let shaped = parts().filter(|(_, part)| part.surface.is_some());
            shaped.map(|(index, _)| below(format!("body[{index}].{first}"))).collect()
        }
        ("size", "") => {
            let blocks = parts().filter(|(_, part)| part.block.is_some());
            blocks.map(|(index, _)| format!("body[{index}].block.size")).collect()
        }
        ("mesh", "bricks" | "subdomains") => {
            let blocks = parts().filter(|(_, part)| part.block.is_some());
            blocks.map(|(index, _)| below(format!("body[{index}].block"))).collect()
        }
        ("counter_surface", _) => match named("upper") {
            Some(body) => vec![below(format!("{body}.block.bottom"))],
            None => {
                let obstacles = file.contact.several().iter().enumerate().filter(|(_, pair)| pair.obstacle.is_some());
                obstacles.map(|(index, _)| below(format!("contact[{index}].obstacle"))).collect()
            }
        },
        ("contact", "normal" | "area" | "interference" | "regions") => {
            (0..file.contact.several().len()).map(|index| below(format!("contact[{index}]"))).collect()
        }
        _ => Vec::new(),
    }
}
