//! Linear coordinates of the variables, in which lengths are measured.

use crate::checks::{check_finite, check_size};
use crate::{InputError, Matrix, plain};
use serde::{Deserialize, Serialize};

/// The regular matrix M of x = M β with its inverse and W = M⁻ᵀ M⁻¹; stored as M alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<f64>>", into = "Vec<Vec<f64>>")]
pub(crate) struct Coordinates {
    pub matrix: Matrix,
    pub inverse: Matrix,
    pub metric: Matrix,
}

impl TryFrom<Matrix> for Coordinates {
    type Error = InputError;

    fn try_from(matrix: Matrix) -> Result<Self, InputError> {
        check_size("scaling.linear", matrix.nrows(), matrix.ncols())?;
        check_finite("scaling.linear", matrix.as_slice())?;
        match matrix.clone().try_inverse().filter(|inverse| inverse.iter().all(|entry| entry.is_finite())) {
            Some(inverse) => {
                let product = inverse.tr_mul(&inverse);
                let metric = (&product + product.transpose()) * 0.5;
                Ok(Self { matrix, inverse, metric })
            }
            None => Err(InputError::OutOfRange {
                setting: "scaling.linear",
                value: "a singular matrix".to_owned(),
                allowed: "a regular matrix",
            }),
        }
    }
}

impl TryFrom<Vec<Vec<f64>>> for Coordinates {
    type Error = String;

    fn try_from(rows: Vec<Vec<f64>>) -> Result<Self, String> {
        Self::try_from(plain::from_rows(&rows)?).map_err(|error| error.to_string())
    }
}

impl From<Coordinates> for Vec<Vec<f64>> {
    fn from(coordinates: Coordinates) -> Self {
        plain::rows(&coordinates.matrix)
    }
}
