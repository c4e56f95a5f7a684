//! A small moving picture for places that run no scripts.

use super::outline::{Outline, View, foot, outline};
use super::recording::Animation;
use crate::report::ReportError;
use ::gif::{Encoder, Frame, Repeat};
use nalgebra::Vector2;

/// Size and speed of a moving picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GifOptions {
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// What the picture's width shows of a dog \[m\]; of larger robots more ([`Animation::unit`]).
    pub across_m: f64,
    /// First time shown \[s\].
    pub from_s: f64,
    /// Last time shown \[s\]: whole cycles make it run smoothly on.
    pub to_s: f64,
    /// Pictures for each second; players bear 50.
    pub rate_hz: f64,
}

impl Default for GifOptions {
    fn default() -> Self {
        Self { width: 480, height: 270, across_m: 0.62, from_s: 0.0, to_s: 10.0, rate_hz: 20.0 }
    }
}

/// Most pictures that are drawn: a walk of five minutes is not for a README.
const MOST_FRAMES: usize = 2000;
/// Samples of a pixel along each side.
const FINE: usize = 2;
/// Greys in the palette; the rest is shared among the robots.
const GREYS: usize = 64;
/// Entries that a palette has.
const ENTRIES: usize = 256;
const SKY: [f64; 3] = [250.0; 3];
const GROUND: [f64; 3] = [224.0; 3];
const MARK: [f64; 3] = [146.0; 3];
const FOOT: [f64; 3] = [40.0, 40.0, 40.0];
/// How far above the floor the side view's eye is \[rad\].
const ABOVE_RAD: f64 = 0.06;

/// Renders a side view that follows the first robot, as an endless GIF. Nothing recorded: no picture, but a valid file.
///
/// # Errors
/// [`ReportError::Gif`] where the encoder refuses.
pub fn animation_gif(animation: &Animation, options: &GifOptions) -> Result<Vec<u8>, ReportError> {
    let (width, height) = (usize::from(options.width.max(1)), usize::from(options.height.max(1)));
    let (palette, mut bytes) = (palette(animation), Vec::new());
    let mut encoder = Encoder::new(&mut bytes, width as u16, height as u16, &palette.concat())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let rate_hz = if options.rate_hz > 0.0 { options.rate_hz.min(50.0) } else { 20.0 };
    let frames = ((options.to_s - options.from_s).max(0.0) * rate_hz).round().max(1.0) as usize;
    for frame in 0..frames.min(MOST_FRAMES) {
        let t_s = options.from_s + frame as f64 / rate_hz;
        let buffer = picture(animation, options, &palette, (width, height), t_s);
        let delay = (100.0 / rate_hz).round() as u16;
        encoder.write_frame(&Frame {
            delay,
            width: width as u16,
            height: height as u16,
            buffer: buffer.into(),
            ..Frame::default()
        })?;
    }
    drop(encoder);
    Ok(bytes)
}

/// All colours: greys, and for each robot its colour from black over itself to white.
fn palette(animation: &Animation) -> Vec<[u8; 3]> {
    let mut palette: Vec<[u8; 3]> = (0..GREYS).map(|k| [(k * 255 / (GREYS - 1)) as u8; 3]).collect();
    let shades = (ENTRIES - GREYS) / animation.dogs.len().max(1);
    for dog in &animation.dogs {
        let shade = |k: usize| {
            let light = 2.0 * k as f64 / (shades.max(2) - 1) as f64;
            let of = |c: u8| {
                if light < 1.0 { f64::from(c) * light } else { f64::from(c) + (255.0 - f64::from(c)) * (light - 1.0) }
            };
            dog.colour.map(|c| of(c).round() as u8)
        };
        palette.extend((0..shades).map(shade));
    }
    palette
}

/// Place of the nearest colour of the palette.
fn nearest(palette: &[[u8; 3]], colour: [f64; 3]) -> u8 {
    let apart = |entry: &[u8; 3]| (0..3).map(|k| (f64::from(entry[k]) - colour[k]).powi(2)).sum::<f64>();
    let mut best = (f64::INFINITY, 0);
    for (k, entry) in palette.iter().enumerate() {
        let apart = apart(entry);
        if apart < best.0 {
            best = (apart, k);
        }
    }
    best.1 as u8
}

/// A picture by places in the palette.
fn picture(
    animation: &Animation,
    options: &GifOptions,
    palette: &[[u8; 3]],
    (width, height): (usize, usize),
    t_s: f64,
) -> Vec<u8> {
    let view = View::side(ABOVE_RAD);
    let mut solids: Vec<(Outline, [f64; 3])> = Vec::new();
    let mut forward_m = 0.0;
    for (index, dog) in animation.dogs.iter().enumerate() {
        let places = dog.recording.at(t_s);
        let colour = dog.colour.map(f64::from);
        if let (0, Some(base)) = (index, places.first()) {
            forward_m = -base.position_m.z;
        }
        for (shape, place) in dog.recording.shapes.iter().zip(&places) {
            // The far side stands back.
            let pale = if place.position_m.x < places[0].position_m.x - 0.02 { 0.35 } else { 0.0 };
            let mix = |c: [f64; 3]| [0, 1, 2].map(|k| c[k] * (1.0 - pale) + SKY[k] * pale);
            solids.push((outline(&view, shape, place), mix(colour)));
            if shape.foot_m > 0.0 {
                let (ball, at) = foot(shape, place);
                let mut ball = outline(&view, &ball, &at);
                ball.near_m += shape.radii_m.x;
                solids.push((ball, mix(FOOT)));
            }
        }
    }
    solids.sort_by(|a, b| a.0.near_m.total_cmp(&b.0.near_m));
    let (fine_width, fine_height) = (width * FINE, height * FINE);
    let scale = fine_width as f64 / (options.across_m * animation.unit).max(1e-3);
    // The floor's line lies at a sixth of the height.
    let low_m = animation.floor_m - fine_height as f64 / scale / 6.0;
    let to_x = |m: f64| (m - forward_m) * scale + fine_width as f64 / 2.0;
    let to_y = |m: f64| fine_height as f64 - (m - low_m) * scale;
    let mut pixels = backdrop((fine_width, fine_height), scale, forward_m, to_y(animation.floor_m));
    for (solid, colour) in &solids {
        let centre = Vector2::new(to_x(solid.centre.x), to_y(solid.centre.y));
        fill(&mut pixels, (fine_width, fine_height), solid, &centre, scale, *colour);
    }
    let mean = |x: usize, y: usize| {
        let mut sum = [0.0; 3];
        for (dy, dx) in (0..FINE).flat_map(|dy| (0..FINE).map(move |dx| (dy, dx))) {
            let pixel = pixels[(y * FINE + dy) * fine_width + x * FINE + dx];
            (0..3).for_each(|k| sum[k] += pixel[k]);
        }
        sum.map(|c| c / (FINE * FINE) as f64)
    };
    // Neighbours are often of one colour.
    let mut known = ([f64::NAN; 3], 0);
    let mut place = |colour: [f64; 3]| {
        if colour != known.0 {
            known = (colour, nearest(palette, colour));
        }
        known.1
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| place(mean(x, y))).collect()
}

/// Sky, floor, and a mark on the floor every 0.1 m that stays where it is.
fn backdrop((width, height): (usize, usize), scale: f64, forward_m: f64, floor_y: f64) -> Vec<[f64; 3]> {
    let mut pixels = vec![SKY; width * height];
    for y in floor_y.clamp(0.0, height as f64) as usize..height {
        for x in 0..width {
            let at_m = forward_m + (x as f64 - width as f64 / 2.0) / scale;
            let from_mark_m = (at_m - (at_m / 0.1).round() * 0.1).abs();
            let is_long = (at_m / 0.1).round() as i64 % 5 == 0;
            let below_m = (y as f64 - floor_y) / scale;
            let is_mark = from_mark_m < 0.0012 && below_m < if is_long { 0.03 } else { 0.015 };
            pixels[y * width + x] = if is_mark || below_m < 0.0012 { MARK } else { GROUND };
        }
    }
    pixels
}

/// Fills an outline, lit from above with a dark rim.
fn fill(
    pixels: &mut [[f64; 3]],
    (width, height): (usize, usize),
    solid: &Outline,
    centre: &Vector2<f64>,
    scale: f64,
    colour: [f64; 3],
) {
    let Some(inverse) = (solid.form * scale * scale).try_inverse() else { return };
    let (reach_x, reach_y) = (solid.form[(0, 0)].sqrt() * scale, solid.form[(1, 1)].sqrt() * scale);
    let range = |middle: f64, reach: f64, end: usize| {
        let clamped = |x: f64| x.clamp(0.0, end as f64) as usize;
        clamped(middle - reach)..clamped(middle + reach + 1.0)
    };
    for y in range(centre.y, reach_y, height) {
        for x in range(centre.x, reach_x, width) {
            // The picture's y goes down, the form's up.
            let from = Vector2::new(x as f64 + 0.5 - centre.x, centre.y - y as f64 - 0.5);
            let inside = from.dot(&(inverse * from));
            if inside <= 1.0 {
                let light = if inside > 0.86 { 0.62 } else { 0.9 + 0.18 * from.y / reach_y };
                pixels[y * width + x] = colour.map(|c| (c * light).min(255.0));
            }
        }
    }
}
