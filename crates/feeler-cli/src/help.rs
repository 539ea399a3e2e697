//! Top-level help: subcommands grouped by topic, wrapped to the terminal's width.

use clap::Command;
use std::fmt::Write;

/// Heading of a group, and the names of its commands.
type Group = (&'static str, &'static [&'static str]);

/// All commands; each is in exactly one group.
const GROUPS: [Group; 6] = [
    (
        "Try it",
        &["list", "run", "view", "report", "replay", "export"],
    ),
    (
        "My fingertip",
        &[
            "cameras",
            "skins",
            "locate",
            "calibrate",
            "verify",
            "sense",
            "score-slip",
            "league",
        ],
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
            "follow",
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

/// Description of the `help` command, which clap only adds when the program runs.
const HELP: &str = "Print this message or the help of a command";

/// Columns before a command's description: two spaces, the longest name, two spaces.
const INDENT: usize = 19;

/// Maximum width of help (columns).
const WIDEST: usize = 120;

/// Minimum plausible width of a terminal (columns).
const NARROWEST: usize = 2 * INDENT;

/// Width without a terminal (columns).
const NO_TERMINAL: usize = 100;

/// Returns `command` with its subcommands listed in groups.
pub fn grouped(command: Command) -> Command {
    let size = terminal_size::terminal_size();
    let told = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = size.map(|(width, _)| usize::from(width.0));
    // A width of 0 means that the terminal does not know its size.
    let told = terminal.or_else(told).filter(|&width| width >= NARROWEST);
    let width = told.unwrap_or(NO_TERMINAL).min(WIDEST);
    let commands = listed(&command, width);
    let header = *command.get_styles().get_header();
    command.term_width(width).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n{commands}\n{header}Options:{header:#}\n{{options}}{{after-help}}"
    ))
}

/// Formats the groups of commands in `width` columns.
fn listed(command: &Command, width: usize) -> String {
    let styles = command.get_styles();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let mut text = String::new();
    for (heading, names) in GROUPS {
        // Writing to a `String` cannot fail.
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

/// Splits `text` into lines of at most `width` columns, except for words that are longer.
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
