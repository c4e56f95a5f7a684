//! A dog that stands on its feet, the right way up, in a page that needs nothing and a picture that is one.

use super::outline::{View, foot, outline};
use super::recording::principal_axes;
use super::*;
use crate::robot::{Dynamics, Floor, FloorParameters, Gait, Model, Setpoints, State, Touching};
use nalgebra::{Matrix3, Vector3};

/// A gait's setpoints as angles, the trunk level at a height at which the lowest foot touches, going forward.
fn walk(gait: &str, speed_m_s: f64) -> Recording {
    let model = Model::ers7();
    let gait = Gait::built_in(gait, model).unwrap();
    let floor = Floor::new(FloorParameters::default(), model, Touching::Marked).unwrap();
    let mut dynamics = Dynamics::new(model);
    let (mut state, mut recording) = (State::at_rest(model), Recording::new(model));
    for k in 0..200 {
        let t_s = 2.0 + 0.02 * f64::from(k);
        gait.setpoints(t_s, &mut state.angle_rad);
        state.base_position_m.z = -speed_m_s * (t_s - 2.0);
        state.base_position_m.y = floor.height_on_m(&mut dynamics, &state);
        recording.push(t_s, dynamics.motions(&state));
    }
    recording
}

fn two_dogs() -> Animation {
    Animation::new("Trot <1 Hz>", "setpoints as angles")
        .with("nominal", walk("trot", 0.06))
        .with("logged", walk("crawl", 0.04))
}

/// Writes what the tests draw where `AIBO_FIT_PICTURES` says, to be looked at.
fn show(name: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("AIBO_FIT_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
    }
}

#[test]
fn the_dog_stands_the_right_way_up() {
    let recording = walk("trot", 0.06);
    assert_eq!((recording.len(), recording.shapes.len()), (200, 19));
    let view = View::side(0.06);
    let places = recording.at(2.0);
    let seen = |name: &str| {
        let k = recording.shapes.iter().position(|shape| shape.name == name).unwrap();
        (outline(&view, &recording.shapes[k], &places[k]), &recording.shapes[k], &places[k])
    };
    // The picture's first axis is to the right and forward, its second up.
    assert!(seen("head").0.centre.x > seen("trunk").0.centre.x && seen("tail").0.centre.x < seen("trunk").0.centre.x);
    for leg in ["lf_lower", "rf_lower", "lr_lower", "rr_lower"] {
        let (lower, shape, place) = seen(leg);
        assert!(lower.centre.y < seen("trunk").0.centre.y - 0.05, "{leg}");
        let (ball, at) = foot(shape, place);
        assert!(at.position_m.y < place.position_m.y && at.position_m.y > 0.9 * ball.radii_m.y, "{leg}");
    }
    assert!(seen("rf_lower").0.near_m > seen("lf_lower").0.near_m);
    // An outline has the size of its part: the trunk's length, seen from the side.
    let (trunk, shape, _) = seen("trunk");
    approx::assert_relative_eq!(trunk.form[(0, 0)].sqrt(), shape.radii_m.z, max_relative = 1e-12);
}

#[test]
fn places_between_frames_lie_between() {
    let recording = walk("trot", 0.06);
    let (a, b, middle) = (recording.at(3.0), recording.at(3.02), recording.at(3.01));
    for ((a, b), middle) in a.iter().zip(&b).zip(&middle) {
        approx::assert_abs_diff_eq!(middle.position_m, (a.position_m + b.position_m) * 0.5, epsilon = 1e-9);
        approx::assert_abs_diff_eq!(
            middle.orientation.angle_to(&a.orientation),
            middle.orientation.angle_to(&b.orientation),
            epsilon = 1e-6
        );
    }
    assert_eq!(recording.at(-1.0), recording.frames[0]);
    assert_eq!(recording.at(99.0), *recording.frames.last().unwrap());
}

#[test]
fn what_cannot_be_drawn_is_left_out() {
    let model = Model::ers7();
    let mut dynamics = Dynamics::new(model);
    let mut recording = Recording::new(model);
    let mut state = State::at_rest(model);
    recording.push(0.0, dynamics.motions(&state));
    recording.push(0.0, dynamics.motions(&state));
    recording.push(f64::NAN, dynamics.motions(&state));
    state.base_position_m.x = f64::NAN;
    recording.push(1.0, dynamics.motions(&state));
    assert_eq!(recording.len(), 1);
    let nothing = Animation::new("empty", "").with("nominal", Recording::new(model));
    assert!(animation_html(&nothing).unwrap().contains("\"frames\":[]"));
    assert!(
        animation_gif(&nothing, &GifOptions { to_s: 0.1, ..GifOptions::default() }).unwrap().starts_with(b"GIF89a")
    );
}

#[test]
fn the_page_needs_no_network_and_is_the_same_every_time() {
    let animation = two_dogs();
    let page = animation_html(&animation).unwrap();
    assert_eq!(page, animation_html(&animation).unwrap());
    for outside in ["http:", "https:", "//cdn", "src=", "@import", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("<title>Trot &lt;1 Hz&gt;</title>"));
    assert!(page.contains("\"name\":\"nominal\"") && page.contains("\"name\":\"logged\""));
    assert_eq!(page.matches("</script>").count(), 1);
    assert!(page.len() < 400_000, "{} bytes for 4 s", page.len());
    show("two.html", page.as_bytes());
    let one = Animation::new("Trot", "one dog").with("nominal", walk("trot", 0.06));
    show("one.html", animation_html(&one).unwrap().as_bytes());
}

#[test]
fn the_moving_picture_shows_the_dog_above_the_floor() {
    let animation = Animation::new("Trot", "").with("nominal", walk("trot", 0.06));
    let options = GifOptions { from_s: 3.0, to_s: 4.0, ..GifOptions::default() };
    let bytes = animation_gif(&animation, &options).unwrap();
    assert!(bytes.len() < 400_000, "{} bytes for 1 s", bytes.len());
    show("one.gif", &bytes);
    let mut decoder = ::gif::DecodeOptions::new();
    decoder.set_color_output(::gif::ColorOutput::RGBA);
    let mut decoder = decoder.read_info(&bytes[..]).unwrap();
    let (mut frames, mut first) = (0, Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.width, frame.height, frame.delay), (480, 270, 5));
        if frames == 0 {
            first = frame.buffer.to_vec();
        } else {
            assert!(frame.buffer.iter().zip(&first).any(|(a, b)| a != b), "it moves");
        }
        frames += 1;
    }
    assert_eq!(frames, 20);
    // Blue pixels of the dog in each row.
    let blue = |row: usize| {
        (0..480).filter(|x| first[(row * 480 + x) * 4 + 2] > first[(row * 480 + x) * 4].saturating_add(60)).count()
    };
    let rows: Vec<usize> = (0..270).filter(|row| blue(*row) > 0).collect();
    let (top, bottom) = (rows[0], rows[rows.len() - 1]);
    // The floor's line is at 5/6 of the height; the feet end there, the head is well above it.
    assert!((215..=232).contains(&bottom) && top < 110, "{top} {bottom}");
    assert!(blue((top + bottom) / 2) > 100);
}

/// A search for the nearest rotation turned for ever at bodies of revolution.
#[test]
fn bodies_of_any_shape_have_axes() {
    for moments in
        [[1.6, 1.6, 0.9], [0.9, 1.6, 1.6], [1.6, 0.9, 1.6], [1.0, 1.0, 1.0], [3.0, 2.0, 1.5], [1.5, 2.0, 3.0]]
    {
        let inertia_kg_m2 = Matrix3::from_diagonal(&(1e-3 * Vector3::from(moments)));
        let (turned, found) = principal_axes(inertia_kg_m2);
        let axes = turned.to_rotation_matrix();
        let again = axes * Matrix3::from_diagonal(&found) * axes.inverse();
        assert!((again - inertia_kg_m2).norm() < 1e-15, "{moments:?}: {again}");
    }
}
