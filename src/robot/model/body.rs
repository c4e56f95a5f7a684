//! A rigid body of the robot, and what may be fixed to it.

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
    /// Whether the file gives it a contact with the floor.
    pub touches_floor: bool,
    /// Mass with everything fixed to it \[kg\].
    pub mass_kg: f64,
    /// Centre of mass in the body's frame \[m\]; the frame lies at the ellipsoid's centre.
    pub centre_of_mass_m: Vector3<f64>,
    /// Inertia about the centre of mass, in the body's axes \[kg m^2\].
    pub inertia_kg_m2: Matrix3<f64>,
    /// Mass and inertia of the part itself, and what was fixed to it.
    part_mass_kg: f64,
    part_inertia_kg_m2: Matrix3<f64>,
    attached: Vec<Attached>,
}

impl Body {
    pub(super) fn of_part(part: &Part) -> Self {
        let inertia = Matrix3::from_diagonal(&part.stated_inertia_kg_m2);
        Self {
            name: part.name.clone(),
            radii_m: part.diameters_m * 0.5,
            touches_floor: part.contact_m.is_some(),
            mass_kg: part.mass_kg,
            centre_of_mass_m: Vector3::zeros(),
            inertia_kg_m2: inertia,
            part_mass_kg: part.mass_kg,
            part_inertia_kg_m2: inertia,
            attached: Vec::new(),
        }
    }

    /// The ellipsoid's lowest point in the body's frame \[m\], for a unit vector `up` in the body's axes.
    ///
    /// `-A^2 up / |A up|` with the semi-axes A: where the outward normal points down.
    pub fn lowest_point_m(&self, up: &Vector3<f64>) -> Vector3<f64> {
        let scaled = self.radii_m.component_mul(up);
        -self.radii_m.component_mul(&scaled) / scaled.norm()
    }

    /// The part with another mass of its own; its inertia grows with it, or follows (3.1) where it had none.
    pub(super) fn set_mass(&mut self, mass_kg: f64) -> Result<(), RobotError> {
        self.require(mass_kg >= 0.0 && mass_kg.is_finite(), "mass_kg", mass_kg, "0 kg or above")?;
        self.part_inertia_kg_m2 = if self.part_mass_kg > 0.0 {
            self.part_inertia_kg_m2 * (mass_kg / self.part_mass_kg)
        } else {
            ellipsoid_inertia_from_diameters(mass_kg, &(self.radii_m * 2.0))
        };
        self.part_mass_kg = mass_kg;
        self.sum_up();
        Ok(())
    }

    pub(super) fn attach(&mut self, extra: Attached) -> Result<(), RobotError> {
        self.require(extra.mass_kg >= 0.0 && extra.mass_kg.is_finite(), "mass_kg", extra.mass_kg, "0 kg or above")?;
        let numbers = extra.at_m.iter().chain(extra.inertia_kg_m2.iter());
        if let Some(&value) = numbers.into_iter().find(|x| !x.is_finite()) {
            return Err(self.wrong("place or inertia", value, "finite numbers"));
        }
        let moments = extra.inertia_kg_m2.symmetric_eigenvalues();
        self.require(moments.min() >= -1e-12 * moments.max().abs(), "inertia", moments.min(), "moments not below 0")?;
        self.attached.push(extra);
        self.sum_up();
        Ok(())
    }

    /// Mass, centre and inertia of part and attachments together.
    fn sum_up(&mut self) {
        self.mass_kg = self.part_mass_kg + self.attached.iter().map(|extra| extra.mass_kg).sum::<f64>();
        let moment: Vector3<f64> = self.attached.iter().map(|extra| extra.at_m * extra.mass_kg).sum();
        self.centre_of_mass_m = if self.mass_kg > 0.0 { moment / self.mass_kg } else { Vector3::zeros() };
        let centre = self.centre_of_mass_m;
        self.inertia_kg_m2 = parallel_axis(&self.part_inertia_kg_m2, self.part_mass_kg, &centre);
        for extra in &self.attached {
            self.inertia_kg_m2 += parallel_axis(&extra.inertia_kg_m2, extra.mass_kg, &(extra.at_m - centre));
        }
    }

    fn require(&self, ok: bool, what: &'static str, value: f64, allowed: &'static str) -> Result<(), RobotError> {
        if ok { Ok(()) } else { Err(self.wrong(what, value, allowed)) }
    }

    fn wrong(&self, what: &'static str, value: f64, allowed: &'static str) -> RobotError {
        RobotError::Value { body: self.name.clone(), what, value, allowed }
    }
}
