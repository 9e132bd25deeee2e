//! How far steps are trusted that reduce the violation.

/// Largest length of the step after one that has failed, in lengths of that step.
const SHORTER: f64 = 0.3;

/// The memory of steps that reduce the violation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RestoringTrust {
    /// The weight κ of the next one; none as long as none has failed.
    pub weight: Option<f64>,
    /// Largest length of the next one.
    pub longest: f64,
}

impl Default for RestoringTrust {
    fn default() -> Self {
        Self { weight: None, longest: f64::INFINITY }
    }
}

impl RestoringTrust {
    /// Learns from a step with a weight and a length that was serious and brought a share of the predicted reduction:
    /// half of it lets the weight fall.
    pub(crate) fn accept(&mut self, weight: f64, share: f64) {
        if self.weight.is_some() {
            let weight = if share >= 0.5 { weight / 10.0 } else { weight };
            *self = Self { weight: Some(weight), longest: f64::INFINITY };
        }
    }

    /// Learns from a step with a weight and a length that has failed.
    pub(crate) fn reject(&mut self, weight: f64, length: f64) {
        *self = Self { weight: Some(10.0 * weight), longest: SHORTER * length };
    }
}

#[cfg(test)]
mod tests {
    use super::RestoringTrust;

    #[test]
    fn the_weight_follows_the_reductions_once_a_step_has_failed() {
        let mut trust = RestoringTrust::default();
        trust.accept(2.0, 0.9);
        assert!(trust.weight.is_none() && trust.longest == f64::INFINITY);
        trust.reject(2.0, 10.0);
        assert_eq!((trust.weight, trust.longest), (Some(20.0), 3.0));
        trust.accept(20.0, 0.4);
        assert_eq!((trust.weight, trust.longest), (Some(20.0), f64::INFINITY));
        trust.accept(20.0, 0.5);
        assert_eq!(trust.weight, Some(2.0));
    }
}
