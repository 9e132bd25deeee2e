//! From a name of the table to its function.

use crate::composition::Outer::{self, LargestMagnitude, Maximum};
use crate::composition::{Composition, Term};
use crate::dual::{Dual, Function};
use crate::penalty::Colville;
use crate::table::Record;
use crate::{approximation, geometry, minimax, penalty, scalable};
use std::sync::Arc;

/// The function of a record, with its structure if it has any; `None` for an unknown name.
pub fn function(record: &Record) -> Option<(Function, Option<Composition>)> {
    if record.name == "Rosenbrock" {
        return Some((Arc::new(minimax::rosenbrock), None));
    }
    let composition = plain(record).or_else(|| with_data(record))?;
    Some((composition.function(), Some(composition)))
}

/// Smooth functions of the variables.
type Smooth = fn(&[Dual]) -> Vec<Dual>;

/// The functions without data.
fn plain(record: &Record) -> Option<Composition> {
    let n = record.dimension;
    let (outer, outputs): (Outer, Smooth) = match record.name.as_str() {
        "CB2" => (Maximum, minimax::cb2),
        "CB3" => (Maximum, minimax::cb3),
        "DEM" => (Maximum, minimax::dem),
        "QL" => (Maximum, minimax::ql),
        "Mifflin1" => (Outer::Sum(vec![(20.0, Term::PositivePart), (1.0, Term::Itself)]), minimax::mifflin1),
        "Mifflin2" => {
            let terms = vec![(1.0, Term::Itself), (1.75, Term::Magnitude), (1.0, Term::Itself)];
            (Outer::Sum(terms), minimax::mifflin2)
        }
        "WF" => (Maximum, minimax::wf),
        "EVD52" => (Maximum, minimax::evd52),
        "Davidon2" => (Maximum, minimax::davidon2),
        "Polak3" => (Maximum, minimax::polak3),
        "MAD1" => (Maximum, minimax::mad1),
        "MAD4" => (Maximum, minimax::mad4),
        "RosenSuzuki" => (Maximum, penalty::rosen_suzuki),
        "Wong1" => (Maximum, penalty::wong1),
        "Wong3" => (Maximum, penalty::wong3),
        "Wong3lin" => (Maximum, penalty::wong3_linear),
        "HS114" => (Maximum, penalty::hs114),
        "Dembo5" => (Maximum, penalty::dembo5),
        "ElAttar" => (Outer::sum_of(Term::Magnitude, 51), approximation::el_attar),
        "PBC1" => (LargestMagnitude, approximation::pbc1),
        "PBC3" => (LargestMagnitude, approximation::pbc3),
        "OET6" => (LargestMagnitude, approximation::oet6),
        "Watson20" => (LargestMagnitude, approximation::watson),
        "PENTAGON" => (Maximum, geometry::pentagon),
        "MAXL" => (LargestMagnitude, scalable::maxl),
        "Goffin" => (Maximum, scalable::goffin),
        "L1HILB" => (Outer::sum_of(Term::Magnitude, n), scalable::hilbert),
        "GenMXHILB" => (LargestMagnitude, scalable::hilbert),
        "ChainedLQ" => (Outer::sum_of(Term::Larger, n - 1), scalable::chained_lq),
        "ChainedCB3II" => (Maximum, scalable::chained_cb3_ii),
        "ActiveFaces" => (LargestMagnitude, scalable::active_faces),
        "ChainedCrescentI" => (Maximum, scalable::chained_crescent_i),
        "ChainedCrescentII" => (Outer::sum_of(Term::Larger, n - 1), scalable::chained_crescent_ii),
        "ChebRosenN1_2" | "ChebRosenN1_5" => (scalable::chebyshev_rosenbrock_outer(n), scalable::chebyshev_rosenbrock),
        "NesterovWorst_20" => (Maximum, scalable::nesterov_worst),
        _ => return None,
    };
    Some(Composition::new(outer, outputs))
}

/// The functions with numeric data of their own.
fn with_data(record: &Record) -> Option<Composition> {
    Some(match record.name.as_str() {
        "Shor" => Composition::new(Maximum, minimax::shor(record.matrix("a"), record.vector("b"))),
        "Maxquad" => Composition::new(Maximum, minimax::maxquad()),
        "Steiner2" => {
            let data = geometry::Steiner {
                x: record.vector("a_x"),
                y: record.vector("a_y"),
                to_fixed: record.vector("p"),
                to_next: record.vector("pt"),
            };
            Composition::new(geometry::steiner_outer(&data), geometry::steiner(data))
        }
        "EQUIL" => {
            let data = (record.matrix("a"), record.matrix("w"), record.vector("b"));
            Composition::new(Maximum, geometry::equilibrium(data.0, data.1, data.2))
        }
        "KowalikOsborne" => {
            Composition::new(LargestMagnitude, approximation::kowalik_osborne(record.vector("y"), record.vector("t")))
        }
        "Colville1" => Composition::new(Maximum, penalty::colville(Colville::new(record))),
        // The dual of Colville's problem shares its data, which the table holds once.
        "ShellDual" => {
            let primal = Colville::published();
            let violations = primal.dimension() + record.dimension;
            Composition::new(penalty::shell_dual_outer(violations), penalty::shell_dual(primal))
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
