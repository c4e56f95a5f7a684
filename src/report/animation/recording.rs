//! What an animation shows.

use crate::number::extent;
use crate::robot::{Body, BodyId, BodyMotion, Dynamics, Model, State, Touch, simulate};
use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Time between two pictures of a motion \[s\].
pub(in crate::report) const PICTURE_S: f64 = 0.04;
/// How far a dog's parts are from its trunk \[m\], and the share by which others may differ and get its picture.
pub(in crate::report) const DOG_M: f64 = 0.2;
const ALIKE: f64 = 1.5;
/// Of the smallest picture.
pub(in crate::report) const LEAST_UNIT: f64 = 0.1;
/// Radius of the ball of the foot \[m\] (Tekkotsu's ERS-7: 23.4 mm across).
const FOOT_M: f64 = 0.0117;
/// Least and greatest semi-axis of a drawn part \[m\].
const THIN_M: f64 = 0.004;
const WIDE_M: f64 = 2.0;

/// A part as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) struct Shape {
    pub name: String,
    /// Semi-axes \[m\].
    pub radii_m: Vector3<f64>,
    /// Radius of the ball of a foot at its lower end \[m\]; 0: it has none.
    pub foot_m: f64,
}

/// Where a part is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Place {
    pub position_m: Vector3<f64>,
    pub orientation: UnitQuaternion<f64>,
}

impl Place {
    /// Between two places, close ones.
    fn between(&self, next: &Self, share: f64) -> Self {
        let (a, mut b) = (self.orientation.into_inner(), next.orientation.into_inner());
        if a.dot(&b) < 0.0 {
            b = -b;
        }
        let blend: Quaternion<f64> = a * (1.0 - share) + b * share;
        Self {
            position_m: self.position_m.lerp(&next.position_m, share),
            orientation: UnitQuaternion::from_quaternion(blend),
        }
    }
}

/// Places of a robot's parts at times. Massless ghosts are not drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    pub(in crate::report) shapes: Vec<Shape>,
    /// Index of each shape's body, and the shape's place in its frame.
    bodies: Vec<(usize, Isometry3<f64>)>,
    pub(super) times_s: Vec<f64>,
    pub(in crate::report) frames: Vec<Vec<Place>>,
}

/// How the axes are turned about which a body has its moments of inertia, and these \[kg m^2\].
pub(super) fn principal_axes(inertia_kg_m2: Matrix3<f64>) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let mut axes = inertia_kg_m2.symmetric_eigen();
    if axes.eigenvectors.determinant() < 0.0 {
        axes.eigenvectors.column_mut(0).neg_mut();
    }
    // As near as any rotation: a search for the nearest need not end where axes are turned by half a turn.
    let turned = Rotation3::from_matrix_unchecked(axes.eigenvectors);
    (UnitQuaternion::from_rotation_matrix(&turned), axes.eigenvalues)
}

impl Recording {
    /// An empty recording of a robot: of its ellipsoids, or where it is not made of these as [`Recording::of_tree`].
    pub fn new(model: &Model) -> Self {
        if !model.bodies().iter().all(Body::is_ellipsoid) {
            return Self::of_tree(model);
        }
        let drawn = model.bodies().iter().enumerate().filter(|(index, body)| *index == 0 || body.mass_kg > 0.0);
        let (bodies, shapes) = drawn
            .map(|(index, body)| {
                let foot_m = if body.touches_floor() { FOOT_M.min(body.radii_m.min()) } else { 0.0 };
                let shape = Shape { name: body.name.clone(), radii_m: body.radii_m, foot_m };
                ((index, Isometry3::identity()), shape)
            })
            .unzip();
        Self { shapes, bodies, times_s: Vec::new(), frames: Vec::new() }
    }

    /// An empty recording of a robot that is known by its joints and inertias: of every body the ellipsoid that has its
    /// inertia, bars from its joint to those that it carries, and its feet.
    pub fn of_tree(model: &Model) -> Self {
        let (mut shapes, mut bodies) = (Vec::new(), Vec::new());
        let far = |body: BodyId| -> Vec<Vector3<f64>> {
            let carried = model.joint_ids().zip(model.joints()).filter(|(id, _)| model.carrier(*id) == body);
            carried.map(|(_, joint)| joint.in_parent_m).collect()
        };
        for (index, (id, body)) in model.body_ids().zip(model.bodies()).enumerate() {
            let mut add = |place: Isometry3<f64>, radii_m: Vector3<f64>| {
                shapes.push(Shape { name: body.name.clone(), radii_m, foot_m: 0.0 });
                bodies.push((index, place));
            };
            if body.mass_kg > 0.0 {
                let (turned, moments) = principal_axes(body.inertia_kg_m2);
                let squared = |k: usize| (moments.sum() - 2.0 * moments[k]) * 2.5 / body.mass_kg;
                let radii_m = Vector3::from_fn(|k, _| squared(k).max(0.0).sqrt().clamp(THIN_M, WIDE_M));
                add(Isometry3::from_parts(body.centre_of_mass_m.into(), turned), radii_m);
            } else if index == 0 {
                // The camera looks at the first part.
                add(Isometry3::identity(), Vector3::repeat(THIN_M));
            }
            let bars: Vec<Vector3<f64>> = far(id).into_iter().chain(feet(body).map(|foot| foot.centre_m)).collect();
            for to_m in bars {
                let along = to_m.norm();
                if along > 2.0 * THIN_M {
                    let turned = UnitQuaternion::rotation_between(&Vector3::x(), &to_m).unwrap_or_default();
                    let thick_m = (0.08 * along).max(THIN_M);
                    add(
                        Isometry3::from_parts((0.5 * to_m).into(), turned),
                        Vector3::new(0.5 * along, thick_m, thick_m),
                    );
                }
            }
        }
        for (index, body) in model.bodies().iter().enumerate() {
            for foot in feet(body) {
                let foot_m = foot.semi_m.column_iter().map(|semi| semi.norm()).fold(THIN_M, f64::max);
                shapes.push(Shape { name: body.name.clone(), radii_m: Vector3::repeat(foot_m), foot_m });
                bodies.push((index, Isometry3::translation(foot.centre_m.x, foot.centre_m.y, foot.centre_m.z)));
            }
        }
        Self { shapes, bodies, times_s: Vec::new(), frames: Vec::new() }
    }

    /// Height of the lowest point, and the greatest distance of any from the first part's place in the first frame \[m\].
    pub fn extent_m(&self) -> [f64; 2] {
        self.extent_of_m(&self.frames)
    }

    fn extent_of_m(&self, frames: &[Vec<Place>]) -> [f64; 2] {
        let middle = frames.first().and_then(|frame| frame.first()).map_or(Vector3::zeros(), |part| part.position_m);
        let points = frames.iter().flat_map(|frame| frame.iter().zip(&self.shapes));
        points.fold([f64::INFINITY, 0.0], |[low, far], (place, shape)| {
            let radius = shape.radii_m.max();
            let own = place.orientation.to_rotation_matrix();
            let down = own.matrix().row(1).transpose().component_mul(&shape.radii_m).norm();
            [low.min(place.position_m.y - down), far.max((place.position_m - middle).norm() + radius)]
        })
    }

    /// A simulated motion, a picture every 0.04 s.
    pub fn of_run(model: &Model, run: &simulate::Recording) -> Self {
        let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
        let mut film = Self::new(model);
        let mut next_s = f64::NEG_INFINITY;
        for (k, t_s) in run.t_s.iter().enumerate() {
            if *t_s < next_s - 1e-9 {
                continue;
            }
            next_s = t_s + PICTURE_S;
            run.state_at(k, &mut state);
            film.push(*t_s, dynamics.motions(&state));
        }
        film
    }

    /// Adds what [`Dynamics::motions`] found at a time. A time that does not come
    /// after the last one, and places that are not finite, are left out: nothing can be drawn of them.
    ///
    /// # Panics
    /// Where `motions` are not those of the model.
    pub fn push(&mut self, t_s: f64, motions: &[BodyMotion]) {
        let is_later = self.times_s.last().is_none_or(|last| t_s > *last);
        let places: Vec<Place> = self.bodies.iter().map(|(body, at)| place(&motions[*body], at)).collect();
        let is_finite = places.iter().all(|place| place.position_m.iter().all(|x| x.is_finite()));
        if is_later && t_s.is_finite() && is_finite {
            self.times_s.push(t_s);
            self.frames.push(places);
        }
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The places at a time, between the frames before and after; the first or last frame outside.
    pub(super) fn at(&self, t_s: f64) -> Vec<Place> {
        let next = self.times_s.partition_point(|t| *t <= t_s);
        match (next.checked_sub(1), self.frames.get(next)) {
            (Some(last), None) => self.frames[last].clone(),
            (None, first) => first.cloned().unwrap_or_default(),
            (Some(here), Some(after)) => {
                let (from_s, to_s) = (self.times_s[here], self.times_s[next]);
                let share = (t_s - from_s) / (to_s - from_s);
                self.frames[here].iter().zip(after).map(|(a, b)| a.between(b, share)).collect()
            }
        }
    }
}

/// What a body stands on.
fn feet(body: &Body) -> impl Iterator<Item = &Touch> {
    body.touches.iter().filter(|touch| touch.is_foot)
}

fn place(motion: &BodyMotion, at: &Isometry3<f64>) -> Place {
    let rotation = Rotation3::from_matrix_unchecked(motion.rotation);
    let body = Isometry3::from_parts(motion.position_m.into(), UnitQuaternion::from_rotation_matrix(&rotation));
    let whole = body * at;
    Place { position_m: whole.translation.vector, orientation: whole.rotation }
}

/// One robot of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Dog {
    /// What the legend says: `nominal`, `repaired`, `logged`.
    pub name: String,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// How it moved.
    pub recording: Recording,
    /// Parts that are lit, by name: those that the joints to blame move.
    pub lit: Vec<String>,
}

/// Several robots in motion over the same floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// Headline.
    pub title: String,
    /// A line under it.
    pub note: String,
    /// Height of the floor (y) \[m\].
    pub floor_m: f64,
    /// The robots; the camera follows the first. The others' differences from the last one can be exaggerated.
    pub dogs: Vec<Dog>,
    /// How large the picture is in units of that of a dog.
    pub unit: f64,
}

/// Colours that the colour-blind can tell apart (Okabe and Ito 2008): blue, vermilion, grey.
const COLOURS: [[u8; 3]; 3] = [[0, 114, 178], [213, 94, 0], [130, 130, 130]];

impl Animation {
    /// An animation without robots, floor at height 0.
    pub fn new(title: impl Into<String>, note: impl Into<String>) -> Self {
        Self { title: title.into(), note: note.into(), floor_m: 0.0, dogs: Vec::new(), unit: 1.0 }
    }

    /// The same with one more robot, in the next colour.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, recording: Recording) -> Self {
        let colour = COLOURS[self.dogs.len() % COLOURS.len()];
        if self.dogs.is_empty() && !recording.is_empty() {
            let [_, far_m] = recording.extent_of_m(&recording.frames[..1]);
            let unit = far_m / DOG_M;
            self.unit = if (1.0 / ALIKE..ALIKE).contains(&unit) { 1.0 } else { unit.max(LEAST_UNIT) };
        }
        self.dogs.push(Dog { name: name.into(), colour, recording, lit: Vec::new() });
        self
    }

    /// The same with parts of all robots lit.
    #[must_use]
    pub fn lit(mut self, parts: &[String]) -> Self {
        self.dogs.iter_mut().for_each(|dog| dog.lit = parts.to_vec());
        self
    }

    /// First and last time of all recordings \[s\]; zeros where nothing was recorded.
    pub fn span_s(&self) -> (f64, f64) {
        let [from, to] = extent(self.dogs.iter().flat_map(|dog| dog.recording.times_s.iter().copied()));
        if from <= to { (from, to) } else { (0.0, 0.0) }
    }
}
