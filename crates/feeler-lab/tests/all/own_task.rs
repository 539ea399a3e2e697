//! Example task of docs/write-a-task.md.

#[path = "../../examples/own_task.rs"]
#[allow(dead_code)]
mod example;

#[test]
fn the_documented_task_runs_to_its_end() {
    example::main().expect("a task that is done");
}

#[test]
fn the_documentation_shows_the_examples_code() {
    let page = include_str!("../../../../docs/write-a-task.md");
    let code = include_str!("../../examples/own_task.rs");
    let shown = page
        .split("```rust\n")
        .skip(1)
        .filter_map(|rest| rest.split("\n```").next());
    let mut lines = 0;
    for block in shown {
        assert!(code.contains(block), "not in the example:\n{block}");
        lines += block.lines().count();
    }
    assert!(lines > 50, "{lines} lines of code in the page");
}
