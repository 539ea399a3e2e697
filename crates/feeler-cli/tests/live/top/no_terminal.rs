//! Without a terminal, the view is refused before anything starts.

use crate::program::{folder, run};
use feeler_watch::{View, ViewError};

#[test]
fn run_with_top_is_refused_without_a_terminal() {
    let folder = folder("top-no-terminal");
    let arguments = ["run", "cap-closing", "--top", "--out=run"];
    run(&folder, &arguments).refused(&["--top", "standard error is not a terminal"]);
    assert!(!folder.join("run").exists());
    if let Err(error) = View::check_terminal() {
        assert!(matches!(error, ViewError::NoTerminal(_)), "{error}");
    }
}

#[test]
fn top_without_a_terminal_suggests_once() {
    let folder = folder("top-no-terminal-rig");
    let refused = run(&folder, &["top", "cap-closing"]);
    refused.refused(&["standard error is not a terminal", "--once"]);
}
