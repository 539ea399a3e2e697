//! HTML pages.

pub(crate) mod calibration;
pub(crate) mod claims_table;
pub(crate) mod compare;
pub(crate) mod document;
pub(crate) mod grasp_slip;
pub(crate) mod grips;
pub(crate) mod identify;
pub(crate) mod law_shares;
pub(crate) mod league;
pub(crate) mod live;
pub(crate) mod ranges_table;
pub(crate) mod robustness;
pub(crate) mod run;
pub(crate) mod slip;
pub(crate) mod sweep;
pub(crate) mod text;
pub(crate) mod tune;
pub(crate) mod wrench;

pub use crate::figures::calibration::{ElementErrors, ElementLoads};
pub use crate::figures::compare::{Curve, Curves, PairedMeasure, Pairs};
pub use crate::figures::identify::FingerProbes;
pub use crate::figures::law_shares::LawShares;
pub use crate::figures::robustness::{Index, Measure, NOTHING, Share, Trace};
pub use crate::figures::slip::Roc;
pub use crate::figures::sweep::{Measured, TrialMeasure, Varied};
pub use crate::figures::wrench::{AxisPoints, PredictedPoint};
pub use calibration::{CalibrationPage, calibration_page};
pub use compare::{ComparePage, ComparedLaw, Row, compare_page};
pub use grasp_slip::{
    GRASP_COLUMNS, GraspDetector, GraspProbability, GraspSlipPage, GraspTiming, GraspTransfer,
    TIMING_COLUMNS, TRANSFER_COLUMNS, base_rate, grasp_slip_page,
};
pub use grips::{GRIP_COLUMNS, GripsPage, grips_page};
pub use identify::{EstimateRow, IdentifyPage, identify_page};
pub use law_shares::{LawSharesPage, law_shares_page};
pub use league::{LeaguePage, LeagueRow, LeagueSet, PublishedFigure, league_page};
pub use live::{Live, LiveRig, live_page};
pub use ranges_table::RangeRow;
pub use robustness::{ALL_OF_HAND, Ending, RobustnessPage, decided_by, robustness_page};
pub use slip::{COLUMNS, OperatingPoint, SlipPage, slip_page};
pub use sweep::{Counted, SweepPage, sweep_page};
pub use text::{number, percent, significant, value};
pub use tune::{ClaimRow, CostRow, SettingRow, TunePage, tune_page};
pub use wrench::{WrenchPage, wrench_page};
