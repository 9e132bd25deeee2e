//! The rows that hold a cluster together, B_c: some gluing rows between its subdomains, which need no multipliers.
//!
//! ```text
//! B_c u = 0:   all Helmert rows of the joints, nodes whose copies all lie in the cluster;   such rows are none of B_E
//! ```

use crate::tfeti::torn::scene_rows::SparseRow;

/// B_c of one cluster.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterRows {
    pub count: usize,
    /// The parts of the rows by subdomain.
    pub members: Vec<MemberRows>,
}

/// The part of B_c on one subdomain.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberRows {
    /// Dofs of the subdomain that have rows, ascending.
    pub dofs: Vec<usize>,
    /// (row, place among `dofs`, value).
    pub entries: Vec<(usize, usize, f64)>,
}

impl ClusterRows {
    /// The parts of `rows` on the subdomains of a cluster; `starts`: the first torn dof of each, then the end.
    pub fn new(rows: &[SparseRow], starts: &[usize]) -> Self {
        let member = |pair: &[usize]| {
            let (first, end) = (pair[0], pair[1]);
            let own =
                || rows.iter().enumerate().flat_map(|(index, row)| row.iter().map(move |&(dof, v)| (index, dof, v)));
            let own = || own().filter(move |(_, dof, _)| (first..end).contains(dof));
            let mut dofs: Vec<usize> = own().map(|(_, dof, _)| dof - first).collect();
            dofs.sort_unstable();
            dofs.dedup();
            let place = |dof: usize| dofs.binary_search(&(dof - first)).expect("invariant: taken from these rows");
            let entries = own().map(|(row, dof, value)| (row, place(dof), value)).collect();
            MemberRows { entries, dofs }
        };
        Self { count: rows.len(), members: starts.windows(2).map(member).collect() }
    }
}
