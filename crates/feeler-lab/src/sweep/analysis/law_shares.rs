//! Fraction of the same hands on which each control law passes the claims about any hand.

use super::robustness::{is_hand, ranges, share};
use crate::sweep::results::claim_columns::ClaimColumns;
use crate::sweep::results::table::Table;
use crate::sweep::trial::Trials;
use feeler_report::pages::{LawShares, LawSharesPage, Share};

/// A law with its trials.
pub struct LawTrials<'a> {
    /// Name of the law.
    pub name: &'a str,
    /// Trials of the law, with the same design and seed as those of the other laws.
    pub trials: &'a Trials,
    /// Table of the trials.
    pub table: &'a Table,
}

/// Computes the fractions over the hands that all `laws` have finished.
///
/// A point of the design counts as a hand if its experiment is valid under any of the laws. A law that rejects the hand
/// fails on it; the number of rejected hands is reported.
pub fn law_shares(laws: &[LawTrials<'_>]) -> LawSharesPage {
    let Some(first) = laws.first() else {
        return LawSharesPage::default();
    };
    let plan = first.trials.plan();
    let finished = Table::common(laws.iter().map(|law| law.table));
    let is_hand_of = |law: &LawTrials<'_>, trial: u64| {
        let row = law.table.rows.get(&trial);
        row.is_some_and(|row| is_hand(law.table, row))
    };
    let is_any = |trial: &&u64| laws.iter().any(|law| is_hand_of(law, **trial));
    let hands: Vec<u64> = finished.iter().filter(is_any).copied().collect();
    let shares = laws.iter().map(|law| LawShares {
        law: law.name.to_string(),
        refused: hands.iter().filter(|&&t| !is_hand_of(law, t)).count() as u64,
        shares: law.shares(&hands),
    });
    LawSharesPage {
        name: plan.origin.clone(),
        seed: plan.seed,
        planned: plan.trials,
        finished: finished.len() as u64,
        hands: hands.len() as u64,
        laws: shares.collect(),
        ranges: ranges(first.trials),
        experiment: plan.experiment.clone(),
    }
}

impl LawTrials<'_> {
    /// Returns the fraction of the trials `hands` that pass each claim about any hand, followed by the fraction that
    /// pass all of these claims and finish the task.
    fn shares(&self, hands: &[u64]) -> Vec<Share> {
        let claims: Vec<_> = self.trials.hand_claims().collect();
        let columns = claims.iter().map(|c| self.table.column(&c.holds()));
        let columns: Vec<_> = columns.collect();
        let is = |trial: u64, column: Option<usize>, text: &str| {
            let field = column.and_then(|c| self.table.rows.get(&trial)?.get(c));
            field.is_some_and(|field| field == text)
        };
        let count = |holds: &dyn Fn(u64) -> bool| hands.iter().filter(|&&t| holds(t)).count();
        let of = |name: &str, holding: usize| share(name, hands.len() as u64, holding as u64);
        let each = claims
            .iter()
            .zip(&columns)
            .map(|(claim, &column)| of(&short(claim), count(&|trial| is(trial, column, "1"))));
        let outcome = self.table.column("outcome");
        let all = |trial| {
            is(trial, outcome, "done") && columns.iter().all(|&column| is(trial, column, "1"))
        };
        each.chain([of("all five", count(&all))]).collect()
    }
}

/// Short name of a claim about any hand.
fn short(claim: &ClaimColumns) -> String {
    let id = claim.id.strip_prefix("hand-").unwrap_or(claim.id);
    id.replace('-', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Experiment;
    use crate::sweep::Plan;

    /// Builds a table from the outcome and the result of the first claim of any hand of each row. The other claims
    /// pass.
    fn table(trials: &Trials, rows: &[(&str, &str)]) -> Table {
        let header = trials.header();
        let claims: Vec<_> = trials.hand_claims().map(ClaimColumns::holds).collect();
        let fields = |&(outcome, first): &(&str, &str)| {
            let field = |name: &String| match name {
                name if name == "outcome" => outcome.to_string(),
                name if *name == claims[0] => first.to_string(),
                name if claims.contains(name) => "1".to_string(),
                _ => String::new(),
            };
            header.iter().map(field).collect()
        };
        Table {
            rows: (0..).zip(rows.iter().map(fields)).collect(),
            header,
        }
    }

    #[test]
    fn a_law_that_rejects_a_hand_fails_on_it() {
        let experiment = Experiment::load("cap-closing", &[]).unwrap();
        let plan = Plan::new(&experiment, "cap-closing", &[], 0, 5).unwrap();
        let trials = Trials::new(&plan).unwrap();
        let rows = [
            ("done", "1"),
            ("done", "0"),
            ("stopped", "1"),
            ("invalid", ""),
            ("done", "1"),
        ];
        let one = table(&trials, &rows);
        // This law rejects the first hand; the last trial is not finished.
        let two = table(
            &trials,
            &[
                ("invalid", ""),
                ("done", "1"),
                ("done", "1"),
                ("invalid", ""),
            ],
        );
        let laws = [("one", &one), ("two", &two)].map(|(name, table)| LawTrials {
            name,
            trials: &trials,
            table,
        });
        let page = law_shares(&laws);
        assert_eq!((page.finished, page.hands), (4, 3));
        let holding = |law: usize| {
            page.laws[law]
                .shares
                .iter()
                .map(|s| s.holding)
                .collect::<Vec<_>>()
        };
        assert_eq!(holding(0), [2, 3, 3, 3, 3, 1]);
        // The row of a rejected hand has no claims.
        assert_eq!((holding(1)[0], holding(1)[5]), (2, 2));
        assert_eq!((page.laws[0].refused, page.laws[1].refused), (0, 1));
        assert_eq!(page.laws[1].shares[5].of, "all five");
        assert_eq!(law_shares(&[]), LawSharesPage::default());
    }
}
