use super::*;
use std::f64::consts::FRAC_PI_2;

/// Three elements in a row, 10 px apart, with the frame of the last one rotated by a right angle.
fn seen() -> [ProjectedElement; 3] {
    [(10.0, 0.0), (20.0, 0.0), (30.0, FRAC_PI_2)].map(|(column, x_angle)| ProjectedElement {
        centre_px: DVec2::new(column, 50.0),
        x_angle,
    })
}

fn refused(text: &str) -> String {
    read_loads(text.as_bytes(), &seen(), ForceAxes::default())
        .unwrap_err()
        .to_string()
}

#[test]
fn pictures_are_gathered_from_rows() {
    let text = "f_z,picture,element,f_x,f_y,note\n# no load\n0,a.png,,,0,\n1.5,b.png,2,0.1,-0.2,x\n0,b.png,0,0,0,\n";
    let pictures = read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap();
    assert_eq!(pictures[0].forces, [Some(DVec3::ZERO); 3]);
    let force = DVec3::new(0.1, -0.2, 1.5);
    assert_eq!(pictures[1].forces, [Some(DVec3::ZERO), None, Some(force)]);
    assert_eq!((pictures.len(), pictures[1].line), (2, 4));
}

#[test]
fn errors_name_the_problem() {
    let head = "picture,element,f_x,f_y,f_z\n";
    for (text, words) in [
        ("picture,element,f_x,f_y\n", "no column \"f_z\""),
        (head, "no loads"),
        ("", "the table is empty"),
        (
            "picture,element,f_x,f_y,f_z\na,0,1,2\n",
            "line 2: 4 cells; expected 5",
        ),
        (
            "picture,element,f_x,f_y,f_z\na,3,1,2,3\n",
            "line 2: element = \"3\"; expected an element from 0 to 2",
        ),
        (
            "picture,element,f_x,f_y,f_z\na,-1,1,2,3\n",
            "element = \"-1\"",
        ),
        (
            "picture;element;f_x;f_y;f_z\na;0;1,234;2;3\n",
            "line 2: f_x = \"1,234\"; expected a finite number, N; its comma may be a decimal comma or a thousands separator",
        ),
        (
            "picture;element;f_x;f_y;f_z\na;0;1,5;2.5;3\n",
            "f_y = \"2.5\"; expected a finite number, N; it has a decimal point, but line 2 has a decimal comma",
        ),
        (
            "picture;element;f_x;f_y\n",
            "no column \"f_z\" in the header \"picture,element,f_x,f_y\", read with a semicolon",
        ),
        (
            "picture,element,f_x,f_y,f_z\na,0,1,NaN,3\n",
            "line 2: f_y = \"NaN\"; expected a finite",
        ),
        ("picture,element,f_x,f_y,f_z\na,0,,2,3\n", "f_x = \"\""),
        (
            "picture,element,f_x,f_y,f_z\na,,0,0,3\n",
            "f_z = \"3\"; expected 0 N",
        ),
        ("picture,element,f_x,f_y,f_z\n,0,0,0,3\n", "picture = \"\""),
        (
            "picture,element,f_x,f_y,f_z\na,0,1,2,3\na,0,1,2,3\n",
            "already in line 2",
        ),
    ] {
        let message = refused(text);
        assert!(message.contains(words), "{message}");
    }
    let _ = read_loads(&b"\xff\xfe\n\xff,,"[..], &seen(), ForceAxes::default()).unwrap_err();
}

#[test]
fn units_and_names_of_other_programs_are_understood() {
    let text = "Picture;Element;Fx [mN];FY;F_Z;column;row;X angle\n;;;N;kN;px;;deg\nb;2,0;500;0,25;0,001;30,0;50,0;0,0\n";
    let pictures = read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap();
    let expected = DVec3::new(0.25, -0.5, 1.0);
    let force = pictures[0].forces[2].unwrap();
    assert!(force.abs_diff_eq(expected, 1e-12), "{force}");
}

const PLACED: &str = "picture,f_x,f_y,f_z,column,row,x_angle\n";

#[test]
fn identifies_elements_by_position() {
    let text = format!("{PLACED}a,,,,,,\nb,1,2,3,21,49,\nb,0.5,0,1,34,48,0\n");
    let pictures = read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap();
    assert_eq!(pictures[0].forces, [Some(DVec3::ZERO); 3]);
    let [first, second, third] = pictures[1].forces[..] else {
        panic!("three elements expected");
    };
    assert_eq!((first, second), (None, Some(DVec3::new(1.0, 2.0, 3.0))));
    // A force along the image's columns is opposite to y of a frame whose x is along the rows.
    let expected = DVec3::new(0.0, -0.5, 1.0);
    assert!(third.unwrap().abs_diff_eq(expected, 1e-12), "{third:?}");
    // Names are arbitrary, as long as each belongs to one element.
    let text = "picture,element,f_x,f_y,f_z,column,row\na,7,1,2,3,10,50\nb,7,1,2,3,11,50\nb,0,1,2,3,30,50\n";
    let pictures = read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap();
    assert!(pictures[1].forces[0].is_some() && pictures[1].forces[2].is_some());
    // A single coordinate is not a position.
    let text = "picture,element,f_x,f_y,f_z,row\na,2,1,2,3,nonsense\n";
    assert!(
        read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap()[0].forces[2].is_some()
    );
}

#[test]
fn keeps_forces_in_a_frame_equal_to_the_layouts() {
    let text = format!("{PLACED}b,0.1,0.7,3,30,50,{FRAC_PI_2}\n");
    let pictures = read_loads(text.as_bytes(), &seen(), ForceAxes::default()).unwrap();
    assert_eq!(pictures[0].forces[2], Some(DVec3::new(0.1, 0.7, 3.0)));
}

#[test]
fn rejects_invalid_positions() {
    for (rows, words) in [
        (
            "a,1,2,3,15,50,\n",
            "line 2: element \"\" at column 15, row 50: the nearest element of the layout, 0, is 5.0 px away; expected less than 5.0",
        ),
        ("a,1,2,3,20,80,\n", "the layout, 1, is 30.0 px away"),
        (
            "a,1,2,3,20,,\n",
            "line 2: row = \"\"; expected a finite number, px",
        ),
        ("a,1,2,3,inf,50,\n", "column = \"inf\""),
        (
            "a,1,2,3,20,50,up\n",
            "x_angle = \"up\"; expected a finite number, rad",
        ),
        (
            "a,1,2,3,20,50,\na,1,2,3,21,50,\n",
            "element 1 already in line 2",
        ),
        ("a,1,2,3,,,\n", "f_x = \"1\"; expected 0 N"),
    ] {
        let message = refused(&format!("{PLACED}{rows}"));
        assert!(message.contains(words), "{message}");
    }
    let head = "picture,element,f_x,f_y,f_z,column,row\n";
    for (rows, words) in [
        (
            "a,7,1,2,3,10,50\nb,8,1,2,3,11,50\n",
            "line 3: element \"8\" is at the place of element 0 of the layout, where element \"7\" is",
        ),
        (
            "a,7,1,2,3,10,50\nb,7,1,2,3,30,50\n",
            "line 3: element \"7\" is at the place of element 2 of the layout, but was at that of element 0",
        ),
        ("a,7,1,2,3,,\n", "line 2: column = \"\""),
    ] {
        let message = refused(&format!("{head}{rows}"));
        assert!(message.contains(words), "{message}");
    }
    assert!(refused("picture,f_x,f_y,f_z\na,1,2,3\n").contains("no column \"element\""));
}
