//! Without a terminal there is no view, and nothing is begun.

use crate::program::{folder, run};
use feeler_watch::{View, ViewError};

#[test]
fn without_a_terminal_the_run_is_refused_before_it_begins() {
    let folder = folder("top-no-terminal");
    let arguments = ["run", "cap-closing", "--top", "--out=run"];
    run(&folder, &arguments).refused(&["--top", "standard error is not a terminal"]);
    assert!(!folder.join("run").exists());
    if let Err(error) = View::check_terminal() {
        assert!(matches!(error, ViewError::NoTerminal(_)), "{error}");
    }
}

#[test]
fn without_a_terminal_a_rig_is_shown_once_or_not_at_all() {
    let folder = folder("top-no-terminal-rig");
    let refused = run(&folder, &["top", "cap-closing"]);
    refused.refused(&["standard error is not a terminal", "--once"]);
}
