//! Vectors and matrices as plain arrays in files: `[1, 2]`, and a matrix as an array of its rows.

use crate::Matrix;

/// For `#[serde(with = "plain::vector")]`.
pub(crate) mod vector {
    use crate::Vector;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(vector: &Vector, serializer: S) -> Result<S::Ok, S::Error> {
        vector.as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vector, D::Error> {
        Vec::deserialize(deserializer).map(Vector::from_vec)
    }
}

/// For `#[serde(with = "plain::matrix")]`.
pub(crate) mod matrix {
    use super::{from_rows, rows};
    use crate::Matrix;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

    pub(crate) fn serialize<S: Serializer>(matrix: &Matrix, serializer: S) -> Result<S::Ok, S::Error> {
        rows(matrix).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Matrix, D::Error> {
        from_rows(&Vec::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

/// The rows of a matrix.
pub(crate) fn rows(matrix: &Matrix) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// The matrix of these rows.
pub(crate) fn from_rows(rows: &[Vec<f64>]) -> Result<Matrix, String> {
    let columns = rows.first().map_or(0, Vec::len);
    match rows.iter().position(|row| row.len() != columns) {
        None => Ok(Matrix::from_fn(rows.len(), columns, |i, j| rows[i][j])),
        Some(i) => Err(format!("row {i} of a matrix has {} entries; allowed: {columns}, as row 0", rows[i].len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vector;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Both {
        #[serde(with = "vector")]
        v: Vector,
        #[serde(with = "matrix")]
        m: Matrix,
    }

    #[test]
    fn arrays_are_plain_and_read_back() {
        let both =
            Both { v: Vector::from_vec(vec![1.5, -2.0]), m: Matrix::from_row_slice(2, 3, &[1., 2., 3., 4., 5., 6.]) };
        let text = serde_json::to_string(&both).expect("numbers");
        assert_eq!(text, r#"{"v":[1.5,-2.0],"m":[[1.0,2.0,3.0],[4.0,5.0,6.0]]}"#);
        assert_eq!(serde_json::from_str::<Both>(&text).expect("arrays"), both);
        let ragged = serde_json::from_str::<Both>(r#"{"v":[],"m":[[1],[2,3]]}"#).expect_err("ragged").to_string();
        assert!(ragged.contains("row 1 of a matrix has 2 entries; allowed: 1"), "{ragged}");
    }
}
