//! The program's help: commands in groups by what a user is doing, as wide as the terminal.

use clap::Command;
use std::fmt::Write;

/// A group of commands: its heading and their names.
type Group = (&'static str, &'static [&'static str]);

/// Each command in one group.
const GROUPS: [Group; 6] = [
    (
        "Try it",
        &["list", "run", "view", "report", "replay", "export"],
    ),
    (
        "My fingertip",
        &["cameras", "locate", "calibrate", "sense", "score-slip"],
    ),
    (
        "My hand",
        &["init", "check", "drives", "identify", "tune", "urdf"],
    ),
    (
        "Experiments",
        &["sweep", "compare", "robustness", "simulate-grasps"],
    ),
    (
        "Several computers",
        &[
            "world",
            "rig",
            "hand",
            "top",
            "stop",
            "resume",
            "ros2",
            "ros2-rig",
            "certificates",
            "schema",
            "bench",
        ],
    ),
    ("This program", &["completions", "man", "help"]),
];

/// What `help` does, which clap adds itself when the program runs.
const HELP: &str = "Print this message or the help of a command";

/// Columns before a command's description: two spaces, the longest name, two spaces.
const INDENT: usize = 19;

/// Widest that help is, columns: longer lines are hard to read.
const WIDEST: usize = 120;

/// Narrowest that a terminal is taken to be, columns.
const NARROWEST: usize = 2 * INDENT;

/// Columns where there is no terminal.
const NO_TERMINAL: usize = 100;

/// The same command, whose help has its commands in groups.
pub fn grouped(command: Command) -> Command {
    let size = terminal_size::terminal_size();
    let told = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = size.map(|(width, _)| usize::from(width.0));
    // None at all, or 0, is a terminal that does not know.
    let told = terminal.or_else(told).filter(|&width| width >= NARROWEST);
    let width = told.unwrap_or(NO_TERMINAL).min(WIDEST);
    let commands = listed(&command, width);
    let header = *command.get_styles().get_header();
    command.term_width(width).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n{commands}\n{header}Options:{header:#}\n{{options}}{{after-help}}"
    ))
}

/// The commands in groups, `width` columns wide.
fn listed(command: &Command, width: usize) -> String {
    let styles = command.get_styles();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let mut text = String::new();
    for (heading, names) in GROUPS {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n{header}{heading}:{header:#}");
        for name in names {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map_or_else(|| HELP.to_string(), ToString::to_string);
            let lines = wrapped(&about, width.saturating_sub(INDENT));
            let name_width = INDENT - 4;
            let _ = write!(text, "  {literal}{name:name_width$}{literal:#}  ");
            let _ = writeln!(text, "{}", lines.join(&format!("\n{:INDENT$}", "")));
        }
    }
    text
}

/// The words of `text` in lines of at most `width` columns, or a word.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command_line;

    #[test]
    fn every_command_is_in_one_group() {
        let command = command_line();
        let commands = command.get_subcommands().map(Command::get_name);
        let mut commands: Vec<_> = commands.chain(["help"]).collect();
        let mut listed: Vec<_> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        commands.sort_unstable();
        listed.sort_unstable();
        assert_eq!(listed, commands);
    }

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        for width in [60, 80, 120] {
            let text = listed(
                &clap::Command::new("x").styles(clap::builder::Styles::plain()),
                width,
            );
            assert!(text.lines().all(|line| line.chars().count() <= width));
            let plain = command_line().styles(clap::builder::Styles::plain());
            let text = listed(&plain, width);
            let long = text.lines().find(|line| line.chars().count() > width);
            assert_eq!(long, None, "{width}");
        }
    }
}
