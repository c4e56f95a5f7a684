//! The page with the moving picture.

use super::recording::{Animation, Dog};
use crate::report::ReportError;
use minijinja::{Environment, context};
use serde_json::{Value, json};

/// Frames for each second that the page gets; it draws between them.
const RATE_HZ: f64 = 25.0;
/// Most frames of a robot on a page; longer walks get fewer for each second.
const MOST_FRAMES: f64 = 3000.0;

/// Renders an animation as one page: play, scrub, speed, camera. It holds everything it needs and loads nothing.
///
/// A fragment opens it at a moment: `walk.html#t=4.2&view=front`. Same animation, same bytes.
///
/// # Errors
/// [`ReportError::Page`] from the template; it does not depend on the data.
pub fn animation_html(animation: &Animation) -> Result<String, ReportError> {
    let (from_s, to_s) = animation.span_s();
    let rate_hz = RATE_HZ.min(MOST_FRAMES / (to_s - from_s).max(1e-3));
    let dogs: Vec<Value> = animation.dogs.iter().map(|dog| of_dog(dog, from_s, to_s, rate_hz)).collect();
    let data = json!({
        "from": from_s, "rate": rate_hz, "floor": animation.floor_m, "unit": animation.unit, "dogs": dogs,
    });
    // A script ends at the first "</script", wherever it stands.
    let data = data.to_string().replace('<', "\\u003c");
    let mut environment = Environment::new();
    environment.add_template("animation.html", include_str!("../templates/animation.html"))?;
    let template = environment.get_template("animation.html")?;
    Ok(template.render(context! { title => animation.title.as_str(), note => animation.note.as_str(), data })?)
}

/// A robot: shapes once, then places frame by frame in whole numbers, 0.1 mm and 1e-4 of a quaternion (x, y, z, w).
fn of_dog(dog: &Dog, from_s: f64, to_s: f64, rate_hz: f64) -> Value {
    let shapes: Vec<Value> = dog
        .recording
        .shapes
        .iter()
        .map(|shape| {
            json!({ "name": shape.name, "radii": shape.radii_m.as_slice(), "foot": shape.foot_m,
            "lit": dog.lit.contains(&shape.name) })
        })
        .collect();
    let whole = |x: f64| (x * 1e4).round() as i64;
    let count = if dog.recording.is_empty() { 0 } else { ((to_s - from_s) * rate_hz).round() as usize + 1 };
    let frame = |k: usize| -> Vec<i64> {
        let places = dog.recording.at(from_s + k as f64 / rate_hz);
        let numbers = places.iter().flat_map(|place| {
            place.position_m.iter().chain(place.orientation.coords.iter()).copied().collect::<Vec<f64>>()
        });
        numbers.map(whole).collect()
    };
    let frames: Vec<Vec<i64>> = (0..count).map(frame).collect();
    let [r, g, b] = dog.colour;
    json!({ "name": dog.name, "colour": [r, g, b], "shapes": shapes, "frames": frames })
}
