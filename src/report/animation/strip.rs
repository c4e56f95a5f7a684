//! One cycle as a row of pictures (Figure 4.4), for a page that does not move.

use super::outline::{Outline, View, foot, outline};
use super::recording::Animation;
use crate::number::math;
use crate::report::plot::canvas::{Look, px, sketch, stroke, text};
use crate::report::{Figure, ReportError};
use nalgebra::Vector2;
use plotters::prelude::{PathElement, Polygon};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

/// Pictures in a row, and rows.
const GRID: (usize, usize) = (4, 2);
/// Size of a picture \[px\].
const SIZE: (f64, f64) = (215.0, 190.0);
/// Metres across a picture of a dog.
const ACROSS_M: f64 = 0.40;
/// Corners of an ellipse.
const CORNERS: usize = 48;

/// The first robot of an animation at eight times of one cycle.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn animation_strip(animation: &Animation, from_s: f64, cycle_s: f64) -> Result<Figure, ReportError> {
    let view = View::side(0.06);
    let scale = SIZE.0 / (ACROSS_M * animation.unit);
    let count = GRID.0 * GRID.1;
    let svg = sketch("one step cycle", 40.0 + SIZE.1 * GRID.1 as f64, |root| {
        let Some(dog) = animation.dogs.first() else { return Ok(()) };
        for k in 0..count {
            let t_s = from_s + cycle_s * k as f64 / count as f64;
            let places = dog.recording.at(t_s);
            let Some(base) = places.first().copied() else { continue };
            let corner = (30.0 + SIZE.0 * (k % GRID.0) as f64, 40.0 + SIZE.1 * (k / GRID.0) as f64);
            let to_px = |p: Vector2<f64>| {
                let right = corner.0 + SIZE.0 / 2.0 + (p.x + base.position_m.z) * scale;
                (px(right), px(corner.1 + SIZE.1 - 30.0 - (p.y - animation.floor_m) * scale))
            };
            let mut solids: Vec<(Outline, RGBColor)> = Vec::new();
            for (shape, place) in dog.recording.shapes.iter().zip(&places) {
                let [r, g, b] = dog.colour;
                let pale = if place.position_m.x < base.position_m.x - 0.02 { 0.45 } else { 0.0 };
                let mix = |c: u8| (f64::from(c) * (1.0 - pale) + 255.0 * pale) as u8;
                solids.push((outline(&view, shape, place), RGBColor(mix(r), mix(g), mix(b))));
                if shape.foot_m > 0.0 {
                    let (ball, at) = foot(shape, place);
                    let mut ball = outline(&view, &ball, &at);
                    ball.near_m += shape.radii_m.x;
                    solids.push((ball, RGBColor(mix(40), mix(40), mix(40))));
                }
            }
            solids.sort_by(|a, b| a.0.near_m.total_cmp(&b.0.near_m));
            let floor_y = px(corner.1 + SIZE.1 - 30.0);
            let ends = [(px(corner.0 + 8.0), floor_y), (px(corner.0 + SIZE.0 - 8.0), floor_y)];
            root.draw(&PathElement::new(ends, stroke(RGBColor(120, 120, 120), 1.0)))?;
            for (solid, colour) in &solids {
                let edge: Vec<(i32, i32)> = rim(solid).into_iter().map(to_px).collect();
                root.draw(&Polygon::new(edge.clone(), colour.filled()))?;
                root.draw(&PathElement::new(edge, stroke(RGBColor(255, 255, 255), 0.6)))?;
            }
            let look = Look { anchor: HPos::Center, size: 11.0, ..Look::default() };
            let words = format!("{:.3} s", cycle_s * k as f64 / count as f64);
            text(root, (corner.0 + SIZE.0 / 2.0, corner.1 + SIZE.1 - 12.0), &words, look)?;
        }
        Ok(())
    })?;
    Ok(Figure {
        file_name: "walk-cycle.svg".to_owned(),
        title: "Figure 4.4, one step cycle".to_owned(),
        caption:
            "Figure 4.4. The robot at eight times of one step cycle [s], from its right side; it walks to the right. \
                  Parts are ellipsoids, of the ERS-7 those of Table A.2; the far legs are pale."
                .to_owned(),
        svg,
    })
}

/// Points around an ellipse: its centre and the root of its form on the unit circle.
fn rim(solid: &Outline) -> Vec<Vector2<f64>> {
    let Some(root) = solid.form.cholesky() else { return Vec::new() };
    let root = root.l();
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / CORNERS as f64;
    (0..=CORNERS).map(|k| solid.centre + root * Vector2::new(math::cos(angle(k)), math::sin(angle(k)))).collect()
}
