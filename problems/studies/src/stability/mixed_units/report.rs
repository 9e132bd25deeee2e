//! What all runs came to: tables, totals, and the list of runs that fell short.

use crate::markdown::{section, table};
use crate::stability::mixed_units::cases::{Given, UnitCase, cases};
use crate::stability::mixed_units::checked_run::{UnitRecord, checked};
use crate::stability::mixed_units::truth::Truth;
use rayon::prelude::*;
use serde::Serialize;

/// Largest spread of the units that the totals speak about.
const USUAL_SPREAD: usize = 3;

/// A share: so many of so many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Share {
    /// Number of runs with the property.
    pub part: usize,
    /// Number of runs considered.
    pub of: usize,
}

impl Share {
    fn count<'r>(records: impl Iterator<Item = &'r UnitRecord>, is_so: impl Fn(&UnitRecord) -> bool) -> Self {
        records.fold(Self::default(), |share, record| Self {
            part: share.part + usize::from(is_so(record)),
            of: share.of + 1,
        })
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let percent = 100.0 * self.part as f64 / self.of.max(1) as f64;
        write!(f, "{} of {} ({percent:.1} %)", self.part, self.of)
    }
}

/// All runs and what they came to.
#[derive(Debug, Clone, Serialize)]
pub struct UnitReport {
    /// Number of runs of all problems, starts and declarations.
    pub runs: usize,
    /// Runs with a false termination.
    pub false_terminations: usize,
    /// Minima reached with units of 1e±3 at most, where a box or outputs are given.
    pub reached_in_usual_units: Share,
    /// Reached minima that are confirmed, where convexity is declared or outputs are given.
    pub said_informed: Share,
    /// Reached minima that are confirmed, where neither convexity is declared nor outputs are given.
    pub said_plain: Share,
    /// All runs, in the order of the problems.
    pub records: Vec<UnitRecord>,
}

impl UnitReport {
    fn new(records: Vec<UnitRecord>) -> Self {
        let reached =
            |informed: bool| records.iter().filter(move |r| r.reached && (r.given != Given::Nothing) == informed);
        let usual = records.iter().filter(|r| r.spread <= USUAL_SPREAD && (r.boxed || r.given == Given::Outputs));
        Self {
            runs: records.len(),
            false_terminations: records.iter().filter(|record| record.false_termination.is_some()).count(),
            reached_in_usual_units: Share::count(usual, |record| record.reached),
            said_informed: Share::count(reached(true), |record| record.said),
            said_plain: Share::count(reached(false), |record| record.said),
            records,
        }
    }

    /// Runs with a false termination.
    pub fn offenders(&self) -> Vec<&UnitRecord> {
        self.records.iter().filter(|record| record.false_termination.is_some()).collect()
    }

    /// The page with totals and tables.
    pub fn markdown(&self) -> String {
        let mut text = format!(
            "{} runs, {} false terminations. Reached with units of 1e±{USUAL_SPREAD} at most and a box or outputs: {}. \
             Confirmed among the reached: {} where convexity is declared or outputs are given, {} where neither is.\n",
            self.runs, self.false_terminations, self.reached_in_usual_units, self.said_informed, self.said_plain
        );
        let given = |record: &UnitRecord| {
            let set = if record.boxed { "box" } else { "no box" };
            format!("{}, {set}", record.given.name())
        };
        text += &self.by("family", |record| format!("{}, {}", record.family, record.given.name()));
        text += &self.by("given", given);
        text += &self.by("units", |record| format!("1e±{}", record.spread));
        text += &self.by("start", |record| record.start.to_owned());
        text + &self.by("offset", |record| format!("{:+}", record.offset))
    }

    /// A table of the runs by what `key` says about them, in the order in which the keys appear.
    fn by(&self, title: &str, key: impl Fn(&UnitRecord) -> String) -> String {
        let mut keys: Vec<String> = vec![];
        for record in &self.records {
            let key = key(record);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        let rows = keys.into_iter().map(|wanted| {
            let of = || self.records.iter().filter(|record| key(record) == wanted);
            let reached = Share::count(of(), |record| record.reached);
            let said = Share::count(of().filter(|record| record.reached), |record| record.said);
            let wrong = of().filter(|record| record.false_termination.is_some()).count();
            let mut evaluations: Vec<usize> = of().map(|record| record.evaluations).collect();
            evaluations.sort_unstable();
            let median = evaluations[evaluations.len() / 2];
            let numbers = [reached.of, reached.part, said.part, wrong, median];
            std::iter::once(wanted).chain(numbers.iter().map(usize::to_string)).collect()
        });
        let head = format!(
            "{title} | runs | reached | confirmed among the reached | false terminations | median of evaluations"
        );
        section(&format!("by {title}"), &head, rows)
    }

    /// The runs that fell short, or all of them, with what is needed to run each alone.
    pub fn list(&self, all: bool) -> String {
        let number = |value: f64| format!("{value:.10e}");
        let rows = self.records.iter().filter(|record| all || record.is_bad()).map(|record| {
            let verdict = match (record.false_termination, record.reached, record.said) {
                (Some(reason), _, _) => format!("FALSE: {reason}"),
                (None, false, _) => "not reached".to_owned(),
                (None, true, false) => "reached, unsaid".to_owned(),
                (None, true, true) => "reached, confirmed".to_owned(),
            };
            vec![
                verdict,
                record.name.clone(),
                number(record.value),
                number(record.minimum),
                format!("{:.1e}", record.excess),
                record.evaluations.to_string(),
                record.termination.clone(),
            ]
        });
        table("verdict | run | value | minimum | excess | evaluations | end", rows)
    }
}

/// All runs of one problem whose names are `wanted`.
fn runs_of(case: &UnitCase, wanted: &(impl Fn(&str) -> bool + Sync)) -> Result<Vec<UnitRecord>, String> {
    let starts = 0..case.problem.starts.len();
    let all = starts.flat_map(|index| Given::ALL.map(|given| (given, index)));
    let chosen: Vec<(Given, usize)> = all.filter(|(given, index)| wanted(&case.name(*given, *index))).collect();
    if chosen.is_empty() {
        return Ok(vec![]);
    }
    let truth =
        Truth::of(&case.problem).map_err(|error| format!("{}: {error}", case.name(chosen[0].0, chosen[0].1)))?;
    let checked = |(given, index)| checked(case, &truth, given, index).map_err(|error| error.to_string());
    chosen.into_iter().map(checked).collect()
}

/// Runs those that `wanted` selects by their names, on all processors; the records are in the order of the problems.
///
/// # Errors
/// A text if a problem cannot be posed or its minimum cannot be found.
pub fn mixed_units(wanted: impl Fn(&str) -> bool + Sync) -> Result<UnitReport, String> {
    let records: Result<Vec<Vec<UnitRecord>>, String> = cases().par_iter().map(|case| runs_of(case, &wanted)).collect();
    Ok(UnitReport::new(records?.into_iter().flatten().collect()))
}
