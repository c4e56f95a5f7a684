//! A rigid body of the robot, and what may be fixed to it.

use super::Touch;
use crate::geometry::Part;
use crate::geometry::inertia::{ellipsoid_inertia_from_diameters, parallel_axis};
use crate::robot::RobotError;
use nalgebra::{Matrix3, Vector3};

/// Something rigidly fixed to a body: a payload, a bench mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attached {
    /// \[kg\]
    pub mass_kg: f64,
    /// Its centre of mass in the body's frame \[m\].
    pub at_m: Vector3<f64>,
    /// Inertia about its own centre of mass, in the body's axes \[kg m^2\]; zeros for a point.
    pub inertia_kg_m2: Matrix3<f64>,
}

impl Attached {
    /// A point mass.
    pub fn point(mass_kg: f64, at_m: Vector3<f64>) -> Self {
        Self { mass_kg, at_m, inertia_kg_m2: Matrix3::zeros() }
    }
}

/// One rigid body: an ellipsoid (Table A.2) with whatever is fixed to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// `rf_lower` for instance.
    pub name: String,
    /// Semi-axes of the ellipsoid along x, y, z \[m\].
    pub radii_m: Vector3<f64>,
    /// What it may touch a floor with.
    pub touches: Vec<Touch>,
    /// Mass with everything fixed to it \[kg\].
    pub mass_kg: f64,
    /// Centre of mass in the body's frame \[m\]; the frame lies at the ellipsoid's centre.
    pub centre_of_mass_m: Vector3<f64>,
    /// Inertia about the centre of mass, in the body's axes \[kg m^2\].
    pub inertia_kg_m2: Matrix3<f64>,
    /// The part itself, and what was fixed to it.
    own: Attached,
    attached: Vec<Attached>,
    is_ellipsoid: bool,
}

impl Body {
    pub(super) fn of_part(part: &Part) -> Self {
        let radii_m = part.diameters_m * 0.5;
        let own = Attached {
            inertia_kg_m2: Matrix3::from_diagonal(&part.stated_inertia_kg_m2),
            ..Attached::point(part.mass_kg, Vector3::zeros())
        };
        let touches = vec![Touch::of_part(&radii_m, part.contact_m.is_some())];
        Self { name: part.name.clone(), radii_m, is_ellipsoid: true, ..Self::of_matter(own, touches) }
    }

    /// One of any shape; `radii_m` are those of its picture.
    ///
    /// # Errors
    /// [`RobotError::Value`] for matter that nothing has.
    pub(super) fn described(
        name: String,
        radii_m: Vector3<f64>,
        own: Attached,
        touches: Vec<Touch>,
    ) -> Result<Self, RobotError> {
        let body = Self { name, radii_m, ..Self::of_matter(own, touches) };
        body.check(&own).map(|()| body)
    }

    fn of_matter(own: Attached, touches: Vec<Touch>) -> Self {
        let mut body = Self {
            name: String::new(),
            radii_m: Vector3::zeros(),
            touches,
            mass_kg: 0.0,
            centre_of_mass_m: Vector3::zeros(),
            inertia_kg_m2: Matrix3::zeros(),
            own,
            attached: Vec::new(),
            is_ellipsoid: false,
        };
        body.sum_up();
        body
    }

    /// Whether it has a foot.
    pub fn touches_floor(&self) -> bool {
        self.touches.iter().any(|touch| touch.is_foot)
    }

    /// The middle of its foot in its frame \[m\]; its origin where it has none.
    pub fn foot_m(&self) -> Vector3<f64> {
        self.touches.iter().find(|touch| touch.is_foot).map_or_else(Vector3::zeros, |touch| touch.centre_m)
    }

    /// Whether it is an ellipsoid about its frame's origin, and not only drawn as one.
    pub fn is_ellipsoid(&self) -> bool {
        self.is_ellipsoid
    }

    /// Its mass without what was fixed to it \[kg\].
    pub fn own_mass_kg(&self) -> f64 {
        self.own.mass_kg
    }

    /// The part with another mass of its own; its inertia grows with it, or follows (3.1) where it had none.
    pub(super) fn set_mass(&mut self, mass_kg: f64) -> Result<(), RobotError> {
        self.require(mass_kg >= 0.0 && mass_kg.is_finite(), "mass_kg", mass_kg, "0 kg or above")?;
        self.own.inertia_kg_m2 = if self.own.mass_kg > 0.0 {
            self.own.inertia_kg_m2 * (mass_kg / self.own.mass_kg)
        } else {
            ellipsoid_inertia_from_diameters(mass_kg, &(self.radii_m * 2.0))
        };
        self.own.mass_kg = mass_kg;
        self.sum_up();
        Ok(())
    }

    pub(super) fn attach(&mut self, extra: Attached) -> Result<(), RobotError> {
        self.check(&extra)?;
        self.attached.push(extra);
        self.sum_up();
        Ok(())
    }

    /// Whether matter is what anything has.
    fn check(&self, extra: &Attached) -> Result<(), RobotError> {
        self.require(extra.mass_kg >= 0.0 && extra.mass_kg.is_finite(), "mass_kg", extra.mass_kg, "0 kg or above")?;
        let numbers = extra.at_m.iter().chain(extra.inertia_kg_m2.iter());
        if let Some(&value) = numbers.into_iter().find(|x| !x.is_finite()) {
            return Err(self.wrong("place or inertia", value, "finite numbers"));
        }
        let moments = extra.inertia_kg_m2.symmetric_eigenvalues();
        self.require(moments.min() >= -1e-12 * moments.max().abs(), "inertia", moments.min(), "moments not below 0")
    }

    /// Mass, centre and inertia of part and attachments together.
    fn sum_up(&mut self) {
        let all = || std::iter::once(&self.own).chain(&self.attached);
        let mass_kg = all().map(|matter| matter.mass_kg).sum();
        let moment: Vector3<f64> = all().map(|matter| matter.at_m * matter.mass_kg).sum();
        let centre = if mass_kg > 0.0 { moment / mass_kg } else { Vector3::zeros() };
        let about = |matter: &Attached| parallel_axis(&matter.inertia_kg_m2, matter.mass_kg, &(matter.at_m - centre));
        let inertia_kg_m2 = all().map(about).sum();
        (self.mass_kg, self.centre_of_mass_m, self.inertia_kg_m2) = (mass_kg, centre, inertia_kg_m2);
    }

    fn require(&self, ok: bool, what: &'static str, value: f64, allowed: &'static str) -> Result<(), RobotError> {
        if ok { Ok(()) } else { Err(self.wrong(what, value, allowed)) }
    }

    fn wrong(&self, what: &'static str, value: f64, allowed: &'static str) -> RobotError {
        RobotError::Value { body: self.name.clone(), what, value, allowed }
    }
}
