//! Text on the screens.

use super::scenes::{idle, screen, silent, slipping, stopped};
use feeler_watch::{Fault, Snapshot};

const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];

/// Asserts that the screen contains all of `words` and none of `absent`.
fn check(snapshot: &Snapshot, words: &[&str], absent: &[&str]) {
    for (width, height) in SIZES {
        let screen = screen(snapshot, width, height);
        for word in words {
            assert!(screen.contains(word), "no {word:?} in\n{screen}");
        }
        for word in absent {
            assert!(!screen.contains(word), "{word:?} in\n{screen}");
        }
    }
}

#[test]
fn screen_of_an_idle_hand() {
    let words = [
        "feeler  cap-closing",
        "0.50 s simulated, 1.0 × real time",
        " SEARCH › move › release › return ",
        "stroke 1 of 4",
        "cap 0.0° (simulated truth)",
        "finger 0",
        "finger 1",
        " touch  slip  over ",
        "0.00 of 1.00 N",
        "no contact",
        "joints 5.7° 28.6° -22.9°",
        "0.0002 N·m",
        "last 2.0 s",
        "sensor 1",
        "100 Hz",
        "12 ms",
        "1.0 %",
        "● alive",
        "no fault so far",
        " q  quit   s  stop the hand   r  resume",
    ];
    check(&idle(), &words, &["TOUCH", "STOPPED", "◉", "▸"]);
}

#[test]
fn screen_of_a_slipping_finger() {
    let words = [
        " search › MOVE › release",
        "stroke 2 of 4",
        " TOUCH  SLIP  over ",
        "1.65 of 1.00 N",
        "cap 28.6°",
        "▸ 6   1.25",
        "  7   0.40",
        "0.0213 N·m",
        "up to 0.0213",
        "█",
    ];
    check(&slipping(), &words, &["STOPPED"]);
    // The largest element, with its number if there is space.
    assert!(screen(&slipping(), 80, 24).contains('◉'));
    assert!(screen(&slipping(), 120, 40).contains("[ 6 ]"));
}

/// Element 6 is in the ring of eight next to the apex, at 225 degrees from y of `T`: below and left. The arrow of a
/// force away from the apex points further in that direction.
#[test]
fn shear_arrow_points_in_the_direction_of_the_force() {
    let screen = screen(&slipping(), 80, 24);
    let lines: Vec<Vec<char>> = screen.lines().map(|line| line.chars().collect()).collect();
    let find = |wanted| {
        let rows = lines.iter().enumerate();
        let mut found = rows.filter_map(|(row, line)| {
            // Search in the right panel, where the drawing is left of the list.
            let column = line[40..59].iter().position(|&c| c == wanted)?;
            Some((row, 40 + column))
        });
        found
            .next()
            .unwrap_or_else(|| panic!("no {wanted} in\n{screen}"))
    };
    let ((row, column), (head_row, head_column)) = (find('◉'), find('↙'));
    assert!(head_row > row && head_column <= column, "{screen}");
}

#[test]
fn screen_of_a_stopped_hand() {
    let words = [
        " search › move › release › return  STOPPED   stroke 2",
        "✗ 3.21 s: the forces of finger 1 are 0.0400 s old (limit 0.035 s)",
    ];
    check(&stopped(), &words, &["no fault"]);
    let mut resumed = stopped();
    resumed.fault.as_mut().unwrap().over = true;
    check(&resumed, &["resolved: 3.21 s: the forces"], &["✗"]);
}

#[test]
fn silent_and_refused_programs_are_shown() {
    let words = ["2.5 s", "✗ REFUSE", " 0.50 s", "7 missed here"];
    check(&silent(), &words, &["simulated", "truth"]);
    let wide = screen(&silent(), 120, 40);
    for word in ["✗ REFUSED: another", "○ silent for 2.5 s"] {
        assert!(wide.contains(word), "no {word:?} in\n{wide}");
    }
    let narrow = screen(&silent(), 80, 24);
    assert!(narrow.contains("2.5 s     10     3 ○ SILENT"), "{narrow}");
}

#[test]
fn screen_without_data() {
    let words = ["no hand found", "no fingers found yet", "no torque sensor"];
    check(&Snapshot::default(), &words, &["stop the hand"]);
}

#[test]
fn omitted_content_is_marked() {
    let mut snapshot = idle();
    snapshot.programs = vec![snapshot.programs[0].clone(); 40];
    check(&snapshot, &["and 3"], &[]);
    snapshot.fault = Some(Fault {
        time: 1.0,
        words: "long ".repeat(100),
        over: false,
    });
    check(&snapshot, &["long lo", "…\n", " q  quit"], &[]);
}

/// In narrow panels, words are dropped before numbers.
#[test]
fn three_and_five_fingers_fit() {
    let mut snapshot = slipping();
    snapshot.title = "a title as long as the line that it stands on, and that is long".into();
    for (fingers, width, height) in [(3, 80, 24), (5, 120, 40)] {
        snapshot.fingers = vec![snapshot.fingers[1].clone(); fingers];
        let screen = screen(&snapshot, width, height);
        for word in ["╭ 1 ", " TOUCH  SLIP  over ", "▸ 6   1.25", " 6° 29° -23° "] {
            assert_eq!(screen.matches(word).count(), fingers, "{word:?}\n{screen}");
        }
        assert!(screen.contains("a title as long") && screen.contains("0.50 s simulated"));
    }
}
