//! What a body weighs: by its `<inertial>`, else by its geoms.

use super::Reader;
use super::body::Content;
use super::compiler::{Compiler, FromGeoms};
use super::geom::{Weight, weight};
use super::orientation::{ORIENTATIONS, pose};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::parts::LinkId;
use crate::robot::description::xml::Element;
use nalgebra::{Matrix3, Vector3};

/// What a body is to what carries it.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Support {
    /// It has joints, or is free.
    Moves,
    /// It has none, and this carries it, which moves.
    Part(LinkId),
    /// It has none, nor has anything that carries it: its weight moves nothing.
    Stands,
}

/// What weighs less has no inertia for MuJoCo.
pub(super) const WEIGHTLESS_KG: f64 = 1e-15;

impl Reader<'_> {
    /// What a body weighs: by its `<inertial>`, else by its geoms. Of one that stands a mesh may keep it to itself.
    pub(super) fn inertia(
        &mut self,
        body: &Element,
        content: &Content<'_>,
        support: Support,
    ) -> Result<RigidInertia, DescriptionError> {
        let mut stated = None;
        let mut unsaid_m = Vector3::from(body.exactly::<3>("pos")?.unwrap_or_default());
        for (element, scope) in &content.inertials {
            let read = read(element, &self.compiler, &mut self.into.warnings)?;
            unsaid_m = (scope.pose * pose(element, &self.compiler)?).translation.vector;
            if stated.replace(read.placed(&scope.pose)).is_some() {
                return Err(element.wrong(format!("a second <inertial> in {}", body.label())));
            }
        }
        let is_enough = match self.compiler.from_geoms {
            FromGeoms::Never => true,
            FromGeoms::Missing => stated.is_some(),
            FromGeoms::Always => false,
        };
        if is_enough {
            return Ok(self.bounded(stated, unsaid_m));
        }
        let mut sum: Option<RigidInertia> = None;
        for (element, scope) in &content.geoms {
            let geom = self.classes.apply(element, scope.childclass)?;
            let group = geom.number("group")?.unwrap_or(0.0);
            let [least, greatest] = self.compiler.geom_groups;
            if group < least || group > greatest {
                continue;
            }
            match weight(&geom, &self.compiler)? {
                Weight::Known(inertia) => *sum.get_or_insert_default() += inertia.placed(&scope.pose),
                Weight::Unknown(geom) => {
                    let what = format!("an inertia from a shape that is not read ({geom})");
                    if support != Support::Stands || self.compiler.total_mass_kg.is_some() {
                        return Err(
                            body.unsupported(what, "add an <inertial>: no mesh and no height field is read here")
                        );
                    }
                    let said = body.say(format!("{what} is left out: it stands still"));
                    self.into.unweighed.get_or_insert_with(|| said.clone());
                    self.into.left_out.push(said);
                }
            }
        }
        // Geoms that weigh nothing say nothing.
        let weighed = sum.filter(|sum| sum.mass_kg > WEIGHTLESS_KG);
        let is_by_inertial = weighed.is_none() && stated.is_some();
        if let Support::Part(carrier) = support
            && self.compiler.is_fusing
            && (is_by_inertial || weighed.is_some() && self.is_by_inertial(carrier))
        {
            let what = "inertiafromgeom=\"true\" with fusestatic, which loses an <inertial> where bodies without joints are fused";
            return Err(body.unsupported(what, "set inertiafromgeom=\"auto\""));
        }
        if is_by_inertial {
            self.by_inertial.push(LinkId(self.into.links.len()));
        }
        Ok(self.bounded(weighed.or(stated), unsaid_m))
    }

    /// Whether a link, or what it is fused to, weighs what its `<inertial>` says though geoms were asked.
    fn is_by_inertial(&self, link: LinkId) -> bool {
        let own = &self.into.links[link.0];
        let above = own.parent.filter(|_| own.joints.is_empty());
        self.by_inertial.contains(&link) || above.is_some_and(|above| self.is_by_inertial(above))
    }
}

/// What an `<inertial>` says, in the axes of what the element stands in.
fn read(inertial: &Element, compiler: &Compiler, warnings: &mut Vec<String>) -> Result<RigidInertia, DescriptionError> {
    let mass_kg = inertial.not_negative("mass")?.ok_or_else(|| inertial.bad("mass", "a mass [kg]"))?;
    if inertial.text("pos").is_none() {
        return Err(inertial.bad("pos", "the centre of mass [m]"));
    }
    let tensor = match (inertial.exactly::<6>("fullinertia")?, inertial.exactly::<3>("diaginertia")?) {
        (Some([xx, yy, zz, xy, xz, yz]), _) => {
            if ORIENTATIONS.iter().any(|name| inertial.text(name).is_some()) {
                return Err(inertial.bad("fullinertia", "no orientation beside it: it is in the body's axes"));
            }
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        }
        (None, Some(moments)) => Matrix3::from_diagonal(&Vector3::from(moments)),
        (None, None) => {
            warnings.push(inertial.say("neither diaginertia nor fullinertia: a point mass"));
            Matrix3::zeros()
        }
    };
    Ok(RigidInertia::about_centre(mass_kg, &tensor, &pose(inertial, compiler)?))
}
