//! HTML pages.

pub(crate) mod calibration;
pub(crate) mod claims_table;
pub(crate) mod compare;
pub(crate) mod document;
pub(crate) mod grasp_slip;
pub(crate) mod identify;
pub(crate) mod law_shares;
pub(crate) mod live;
pub(crate) mod ranges_table;
pub(crate) mod robustness;
pub(crate) mod run;
pub(crate) mod slip;
pub(crate) mod sweep;
pub(crate) mod text;
pub(crate) mod tune;
pub(crate) mod wrench;

pub use calibration::{CalibrationPage, ElementErrors, ElementLoads, calibration_page};
pub use compare::{
    ComparePage, ComparedLaw, Curve, Curves, PairedMeasure, Pairs, Row, compare_page, number,
};
pub use grasp_slip::{
    GRASP_COLUMNS, GraspDetector, GraspSlipPage, GraspTransfer, TRANSFER_COLUMNS, base_rate,
    grasp_slip_page,
};
pub use identify::{EstimateRow, FingerProbes, IdentifyPage, identify_page};
pub use law_shares::{LawShares, LawSharesPage, law_shares_page};
pub use live::{Live, LiveRig, live_page};
pub use ranges_table::RangeRow;
pub use robustness::{
    ALL_OF_HAND, Ending, Index, Measure, NOTHING, RobustnessPage, Share, Trace, decided_by,
    percent, robustness_page,
};
pub use slip::{COLUMNS, OperatingPoint, Roc, SlipPage, slip_page};
pub use sweep::{Counted, Measured, SweepPage, TrialMeasure, Varied, sweep_page};
pub use text::{significant, value};
pub use tune::{ClaimRow, CostRow, SettingRow, TunePage, tune_page};
pub use wrench::{AxisPoints, PredictedPoint, WrenchPage, wrench_page};
