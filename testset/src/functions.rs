//! From a name of the table to its function.

use crate::dual::{Dual, Function};
use crate::table::Record;
use crate::{approximation, geometry, minimax, penalty, scalable};
use std::sync::Arc;

/// The function of a record, `None` for an unknown name.
pub fn function(record: &Record) -> Option<Function> {
    let plain: fn(&[Dual]) -> Dual = match record.name.as_str() {
        "Rosenbrock" => minimax::rosenbrock,
        "CB2" => minimax::cb2,
        "CB3" => minimax::cb3,
        "DEM" => minimax::dem,
        "QL" => minimax::ql,
        "Mifflin1" => minimax::mifflin1,
        "Mifflin2" => minimax::mifflin2,
        "WF" => minimax::wf,
        "EVD52" => minimax::evd52,
        "Davidon2" => minimax::davidon2,
        "Polak3" => minimax::polak3,
        "MAD1" => minimax::mad1,
        "MAD4" => minimax::mad4,
        "RosenSuzuki" => penalty::rosen_suzuki,
        "Wong1" => penalty::wong1,
        "Wong3" => penalty::wong3,
        "Wong3lin" => penalty::wong3_linear,
        "HS114" => penalty::hs114,
        "Dembo5" => penalty::dembo5,
        "ElAttar" => approximation::el_attar,
        "PBC1" => approximation::pbc1,
        "PBC3" => approximation::pbc3,
        "OET6" => approximation::oet6,
        "Watson20" => approximation::watson,
        "PENTAGON" => geometry::pentagon,
        "MAXL" => scalable::maxl,
        "Goffin" => scalable::goffin,
        "L1HILB" => scalable::l1_hilbert,
        "GenMXHILB" => scalable::max_hilbert,
        "ChainedLQ" => scalable::chained_lq,
        "ChainedCB3II" => scalable::chained_cb3_ii,
        "ActiveFaces" => scalable::active_faces,
        "ChainedCrescentI" => scalable::chained_crescent_i,
        "ChainedCrescentII" => scalable::chained_crescent_ii,
        "ChebRosenN1_2" | "ChebRosenN1_5" => scalable::chebyshev_rosenbrock,
        "NesterovWorst_20" => scalable::nesterov_worst,
        _ => return with_data(record),
    };
    Some(Arc::new(plain))
}

/// The functions with numeric data of their own.
fn with_data(record: &Record) -> Option<Function> {
    Some(match record.name.as_str() {
        "Shor" => minimax::shor(record.matrix("a"), record.vector("b")),
        "Maxquad" => minimax::maxquad(),
        "Steiner2" => geometry::steiner(geometry::Steiner {
            x: record.vector("a_x"),
            y: record.vector("a_y"),
            to_fixed: record.vector("p"),
            to_next: record.vector("pt"),
        }),
        "EQUIL" => geometry::equilibrium(record.matrix("a"), record.matrix("w"), record.vector("b")),
        "KowalikOsborne" => approximation::kowalik_osborne(record.vector("y"), record.vector("t")),
        "Colville1" => penalty::colville(penalty::Colville::new(record)),
        // The dual of Colville's problem shares its data, which the table holds once.
        "ShellDual" => {
            let primal = crate::table::records().into_iter().find(|primal| primal.name == "Colville1")?;
            penalty::shell_dual(penalty::Colville::new(&primal))
        }
        _ => return None,
    })
}

/// Lower corner of the orthant on which a problem marked convex is convex.
pub fn convex_lower(name: &str, dimension: usize) -> Vec<f64> {
    let mut lower = vec![f64::NEG_INFINITY; dimension];
    match name {
        // Cubic terms with positive coefficients.
        "Colville1" => lower.fill(0.0),
        // 7 x₆² − 4 x₆ x₇ + x₇⁴ has a positive semidefinite Hessian iff x₇² ≥ 2/21.
        "Wong1" => lower[6] = (2.0_f64 / 21.0).sqrt(),
        _ => {}
    }
    lower
}
