//! How sure an engineer is of what a study states.

/// Table `[uncertain]`: relative standard deviations of what a study states; 0: exact.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertain {
    /// Inertia of a link.
    pub inertia: Spread,
    /// Moment of a link.
    pub moment: Spread,
    /// Masses of a robot's parts.
    pub mass: Spread,
    /// Coulomb and viscous friction, and at least 1 % of the largest torque seen.
    pub friction: Spread,
    /// `kp`, `ki`, `kd`.
    pub gain: Spread,
    /// Scale of a `tau` column, torque limits.
    pub torque: Spread,
    /// The floor's parameters.
    pub floor: Spread,
}

/// A relative standard deviation, for all numbers of a kind and by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// Where no name is given.
    pub all: f64,
    /// By the name of a number.
    pub by_name: std::collections::BTreeMap<String, f64>,
}

impl Spread {
    /// The same for every number.
    pub fn of_all(all: f64) -> Self {
        Self { all, by_name: Default::default() }
    }

    /// Of the number with this name.
    pub fn of(&self, name: &str) -> f64 {
        self.by_name.get(name).copied().unwrap_or(self.all)
    }
}

impl Default for Uncertain {
    fn default() -> Self {
        Self {
            inertia: Spread::of_all(0.10),
            moment: Spread::of_all(0.05),
            mass: Spread::of_all(0.05),
            friction: Spread::of_all(0.5),
            gain: Spread::of_all(0.10),
            torque: Spread::of_all(0.10),
            floor: Spread::of_all(0.3),
        }
    }
}
