//! `<compiler>`: how the rest of the file is meant.

use super::orientation::Sequence;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;

/// Whether inertias come from geoms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FromGeoms {
    /// Never.
    Never,
    /// Wherever there are geoms.
    Always,
    /// Where there is no `<inertial>`.
    Missing,
}

/// The settings that matter for dynamics; all `<compiler>` elements of a file and its includes together.
#[derive(Clone, Debug)]
pub(super) struct Compiler {
    pub is_degrees: bool,
    pub is_autolimits: bool,
    pub sequence: Sequence,
    pub from_geoms: FromGeoms,
    pub geom_groups: [f64; 2],
    pub least_mass_kg: f64,
    pub least_moment_kg_m2: f64,
    pub is_balancing: bool,
    pub total_mass_kg: Option<f64>,
    pub is_fusing: bool,
    pub is_aligning: bool,
}

impl Compiler {
    /// Reads the settings.
    pub fn read(root: &Element) -> Result<Self, DescriptionError> {
        let mut settings = Self {
            is_degrees: true,
            is_autolimits: true,
            sequence: Sequence::default(),
            from_geoms: FromGeoms::Missing,
            geom_groups: [0.0, 5.0],
            least_mass_kg: 0.0,
            least_moment_kg_m2: 0.0,
            is_balancing: false,
            total_mass_kg: None,
            is_fusing: false,
            is_aligning: false,
        };
        root.all("compiler").try_for_each(|compiler| settings.apply(compiler))?;
        Ok(settings)
    }

    fn apply(&mut self, of: &Element) -> Result<(), DescriptionError> {
        let yes = [("true", true), ("false", false)];
        if of.text("coordinate").is_some_and(|text| text != "local") {
            let hint = "MuJoCo gave it up too; convert the file with an old release";
            return Err(of.unsupported("coordinate=\"global\"", hint));
        }
        self.is_degrees = of.word("angle", &[("degree", true), ("radian", false)])?.unwrap_or(self.is_degrees);
        self.is_autolimits = of.word("autolimits", &yes)?.unwrap_or(self.is_autolimits);
        if let Some(text) = of.text("eulerseq") {
            self.sequence = Sequence::of(text).ok_or_else(|| of.bad("eulerseq", "three of x, y, z, X, Y, Z"))?;
        }
        let from = [("false", FromGeoms::Never), ("true", FromGeoms::Always), ("auto", FromGeoms::Missing)];
        self.from_geoms = of.word("inertiafromgeom", &from)?.unwrap_or(self.from_geoms);
        self.geom_groups = of.exactly("inertiagrouprange")?.unwrap_or(self.geom_groups);
        self.least_mass_kg = of.not_negative("boundmass")?.unwrap_or(self.least_mass_kg);
        self.least_moment_kg_m2 = of.not_negative("boundinertia")?.unwrap_or(self.least_moment_kg_m2);
        self.is_balancing = of.word("balanceinertia", &yes)?.unwrap_or(self.is_balancing);
        if let Some(total) = of.number("settotalmass")? {
            self.total_mass_kg = (total > 0.0).then_some(total);
        }
        self.is_fusing = of.word("fusestatic", &yes)?.unwrap_or(self.is_fusing);
        self.is_aligning = of.word("alignfree", &yes)?.unwrap_or(self.is_aligning);
        Ok(())
    }

    /// An angle as it is written \[rad\].
    pub fn angle(&self, written: f64) -> f64 {
        if self.is_degrees { written.to_radians() } else { written }
    }
}
