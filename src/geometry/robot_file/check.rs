//! From the TOML to checked tables in SI units.

use super::raw::{
    Number, RawAttached, RawAxis, RawEffect, RawEncoder, RawFriction, RawGains, RawJoint, RawPart, RawRobot, RawSensor,
    RawSpring, Text, Triple,
};
use super::{
    Base, EncoderData, FileAttached, FileEffect, FrictionSet, GainSet, JointFriction, RobotTables, SCHEMA, SensorRange,
    tree,
};
use crate::geometry::inertia::ellipsoid_inertia_from_diameters;
use crate::geometry::tables::{Joint, JointSpring, Part};
use crate::log::{Document, LogError, NOT_NEGATIVE, POSITIVE, Range64, finite_within};
use crate::number::STANDARD_GRAVITY_M_S2;
use nalgebra::{Unit, Vector3};
use std::f64::consts::TAU;
use toml::Spanned;

/// A unit vector may be off by this much: it is written with four digits or more.
const UNIT_TOLERANCE: f64 = 1e-4;
/// Share by which a rounded moment of inertia may exceed the sum of the other two.
const TRIANGLE_TOLERANCE: f64 = 0.01;
/// Shifts are those of a 16 bit word.
const LARGEST_SHIFT: i64 = 16;

const LENGTH_MM: Range64 = finite_within(1e5, "a length within 1e5 mm");
const PHI_DEG: Range64 = finite_within(360.0, "an angle within 360 degrees");
const LIMIT_RAD: Range64 = finite_within(10.0 * TAU, "an angle within 63 rad; a larger one looks like degrees");
const GRAVITY: Range64 = finite_within(1e3, "an acceleration within 1e3 m/s^2");
const SLOPE: Range64 = finite_within(1.2, "an angle within 1.2 rad");
const PLACE_M: Range64 = finite_within(1e2, "a length within 1e2 m");
const READING: Range64 = finite_within(f64::MAX, "a finite number");

/// The tables of a file.
pub(super) fn checked(document: &Document<'_>) -> Result<RobotTables, LogError> {
    let raw: RawRobot = document.parse()?;
    let schema = *raw.schema.get_ref();
    if schema != SCHEMA {
        let expected = "1, the only schema there is";
        return Err(document.wrong("schema", raw.schema.span(), schema.to_string(), expected));
    }
    tree::check(document, &raw)?;
    let clamped = [("floating", Base::Floating), ("clamped", Base::Clamped)];
    let base = document.word("base", &raw.base, &clamped)?.unwrap_or(Base::Floating);
    let gravity_m_s2 = match &raw.gravity_m_s2 {
        Some(gravity) => triple(document, "gravity_m_s2", gravity, GRAVITY)?,
        None => Vector3::new(0.0, -STANDARD_GRAVITY_M_S2, 0.0),
    };
    let joints: Vec<Joint> = raw.joint.iter().map(|joint| self::joint(document, joint)).collect::<Result<_, _>>()?;
    let known = |name: &str| joints.iter().any(|joint| joint.name == name || joint.kind == name);
    let friction =
        raw.friction.iter().map(|(name, set)| friction(document, name, set, &known)).collect::<Result<_, _>>()?;
    let gains = raw.gains.iter().map(|(name, set)| gains(document, name, set, &known)).collect::<Result<_, _>>()?;
    let effects = raw.effect.iter().map(|of| effect(document, of, &known)).collect::<Result<_, _>>()?;
    let is_part = |name: &str| raw.part.iter().any(|part| part.name.get_ref() == name);
    let attached = raw.attached.iter().map(|of| self::attached(document, of, &is_part)).collect::<Result<_, _>>()?;
    let floor = raw.floor.as_ref().map(|floor| crate::log::floor(document, floor)).transpose()?;
    let slope = raw.floor_slope_rad.as_ref();
    for angle in slope.into_iter().flat_map(|slope| slope.get_ref().map(|angle| (slope.span(), angle))) {
        document.within("floor_slope_rad", angle.0, angle.1, SLOPE)?;
    }
    let floor_slope_rad = slope.map_or([0.0; 2], |slope| *slope.get_ref());
    Ok(RobotTables {
        effects,
        attached,
        floor,
        floor_slope_rad,
        name: raw.name,
        root: raw.root.into_inner(),
        base,
        gravity_m_s2,
        parts: raw.part.iter().map(|part| self::part(document, part)).collect::<Result<_, _>>()?,
        joints,
        friction,
        gains,
        encoder: raw.encoder.as_ref().map(|encoder| self::encoder(document, encoder)).transpose()?,
        sensors: raw.sensor.into_iter().map(|sensor| self::sensor(document, sensor)).collect::<Result<_, _>>()?,
    })
}

fn part(document: &Document<'_>, raw: &RawPart) -> Result<Part, LogError> {
    let key = |key: &str| format!("[[part]] {} {key}", raw.name.get_ref());
    let diameters_m = triple(document, &key("diameter_m"), &raw.diameter_m, POSITIVE)?;
    let mass_kg = number(document, &key("mass_kg"), &raw.mass_kg, NOT_NEGATIVE)?;
    let stated_inertia_kg_m2 = match &raw.inertia_kg_m2 {
        Some(stated) => {
            let inertia = triple(document, &key("inertia_kg_m2"), stated, NOT_NEGATIVE)?;
            if 2.0 * inertia.max() > inertia.sum() * (1.0 + TRIANGLE_TOLERANCE) {
                let found = format!("{:?}", stated.get_ref());
                let expected = "three moments of which none exceeds the sum of the others, as a rigid body has";
                return Err(document.wrong(&key("inertia_kg_m2"), stated.span(), found, expected));
            }
            inertia
        }
        None => ellipsoid_inertia_from_diameters(mass_kg, &diameters_m).diagonal(),
    };
    let contact_m = match &raw.contact_mm {
        Some(contact) => Some(metres(document, &key("contact_mm"), contact)?),
        None => None,
    };
    Ok(Part { name: raw.name.get_ref().clone(), diameters_m, mass_kg, stated_inertia_kg_m2, contact_m })
}

fn joint(document: &Document<'_>, raw: &RawJoint) -> Result<Joint, LogError> {
    let name = raw.name.get_ref();
    let key = |key: &str| format!("[[joint]] {name} {key}");
    let sign = match &raw.sign {
        None => 1.0,
        Some(sign) if sign.get_ref().abs() == 1 => *sign.get_ref() as f64,
        Some(sign) => return Err(document.wrong(&key("sign"), sign.span(), sign.get_ref().to_string(), "1 or -1")),
    };
    let phi_rad = match &raw.phi_deg {
        Some(phi) => triple(document, &key("phi_deg"), phi, PHI_DEG)?.map(f64::to_radians),
        None => Vector3::zeros(),
    };
    let limits = |what: &str, limits: &Option<Spanned<[f64; 2]>>| {
        limits.as_ref().map(|limits| range(document, &key(what), limits, LIMIT_RAD)).transpose()
    };
    let (hardware_rad, software_rad) =
        (limits("hardware_rad", &raw.hardware_rad)?, limits("software_rad", &raw.software_rad)?);
    if let (Some(hard), Some(soft), Some(at)) = (hardware_rad, software_rad, &raw.software_rad)
        && (soft[0] < hard[0] || soft[1] > hard[1])
    {
        let expected = format!("a range within hardware_rad = {hard:?}");
        return Err(document.wrong(&key("software_rad"), at.span(), format!("{soft:?}"), &expected));
    }
    let speed_rad_s =
        raw.speed_rad_s.as_ref().map(|speed| number(document, &key("speed_rad_s"), speed, POSITIVE)).transpose()?;
    Ok(Joint {
        name: name.clone(),
        kind: raw.kind.clone().unwrap_or_else(|| name.clone()),
        parent: raw.parent.get_ref().clone(),
        child: raw.child.get_ref().clone(),
        axis: axis(document, &key("axis"), &raw.axis)?,
        sign,
        in_parent_m: metres(document, &key("parent_mm"), &raw.parent_mm)?,
        in_child_m: metres(document, &key("child_mm"), &raw.child_mm)?,
        phi_rad,
        hardware_rad,
        software_rad,
        speed_rad_s,
        spring: raw.spring.as_ref().map(|spring| self::spring(document, name, spring)).transpose()?,
    })
}

fn axis(document: &Document<'_>, key: &str, raw: &Spanned<RawAxis>) -> Result<Unit<Vector3<f64>>, LogError> {
    let (found, length) = match raw.get_ref() {
        RawAxis::Letter(letter) => match letter.as_str() {
            "x" => return Ok(Vector3::x_axis()),
            "y" => return Ok(Vector3::y_axis()),
            "z" => return Ok(Vector3::z_axis()),
            _ => (format!("{letter:?}"), None),
        },
        RawAxis::Vector(vector) => {
            let length = Vector3::from(*vector).norm();
            if (length - 1.0).abs() <= UNIT_TOLERANCE {
                return Ok(Unit::new_normalize(Vector3::from(*vector)));
            }
            (format!("{vector:?}"), Some(length))
        }
    };
    let of_length = length.map_or_else(String::new, |length| format!(" of length {length:.4}"));
    let expected = "\"x\", \"y\", \"z\" or a vector of length 1";
    Err(document.wrong(key, raw.span(), found + &of_length, expected))
}

fn spring(document: &Document<'_>, joint: &str, raw: &RawSpring) -> Result<JointSpring, LogError> {
    let key = |key: &str| format!("[[joint]] {joint} spring.{key}");
    let or_zero = |what: &str, value: &Option<Number>, range: Range64| {
        value.as_ref().map_or(Ok(0.0), |value| number(document, &key(what), value, range))
    };
    Ok(JointSpring {
        stiffness_nm_rad: number(document, &key("stiffness_nm_rad"), &raw.stiffness_nm_rad, NOT_NEGATIVE)?,
        damping_nm_s_rad: or_zero("damping_nm_s_rad", &raw.damping_nm_s_rad, NOT_NEGATIVE)?,
        rest_rad: or_zero("rest_rad", &raw.rest_rad, LIMIT_RAD)?,
    })
}

fn friction(
    document: &Document<'_>,
    name: &str,
    raw: &RawFriction,
    known: &dyn Fn(&str) -> bool,
) -> Result<FrictionSet, LogError> {
    let key = |key: &str| format!("[friction.{name}] {key}");
    let joints = raw.joints.get_ref();
    for joint in joints {
        known_joint(document, &key("joints"), joint, known)?;
    }
    let column = |what: &str, values: &Option<Spanned<Vec<f64>>>| -> Result<Vec<f64>, LogError> {
        let Some(values) = values else { return Ok(vec![0.0; joints.len()]) };
        if values.get_ref().len() != joints.len() {
            let (found, expected) =
                (format!("{} values", values.get_ref().len()), format!("{} as in `joints`", joints.len()));
            return Err(document.wrong(&key(what), values.span(), found, &expected));
        }
        let each = |value: &f64| document.within(&key(what), values.span(), *value, NOT_NEGATIVE);
        values.get_ref().iter().map(each).collect()
    };
    let coulomb = column("coulomb_nm", &raw.coulomb_nm)?;
    let viscous = column("viscous_nm_s_rad", &raw.viscous_nm_s_rad)?;
    let fixed = column("static_nm", &raw.static_nm)?;
    let stribeck = column("stribeck_rad_s", &raw.stribeck_rad_s)?;
    let steepness = column("steepness_s_rad", &raw.steepness_s_rad)?;
    let row = |k: usize| JointFriction {
        coulomb_nm: coulomb[k],
        viscous_nm_s_rad: viscous[k],
        static_nm: fixed[k],
        stribeck_rad_s: stribeck[k],
        steepness_s_rad: steepness[k],
    };
    let by_joint = joints.iter().enumerate().map(|(k, joint)| (joint.get_ref().clone(), row(k))).collect();
    Ok(FrictionSet { name: name.to_owned(), by_joint })
}

fn gains(
    document: &Document<'_>,
    name: &str,
    raw: &RawGains,
    known: &dyn Fn(&str) -> bool,
) -> Result<GainSet, LogError> {
    let shift = raw.shift.get_ref().map(|s| u8::try_from(s).ok().filter(|_| s <= LARGEST_SHIFT));
    let [Some(p), Some(i), Some(d)] = shift else {
        let (key, found) = (format!("[gains.{name}] shift"), format!("{:?}", raw.shift.get_ref()));
        return Err(document.wrong(
            &key,
            raw.shift.span(),
            found,
            "three shifts s from 0 to 16; gain = g / 2^(16 - s)",
        ));
    };
    let mut by_joint = Vec::new();
    for (joint, g) in &raw.g {
        known_joint(document, &format!("[gains.{name}.g] {}", joint.get_ref()), joint, known)?;
        let words = g.get_ref().map(|g| u16::try_from(g).ok());
        let [Some(kp), Some(ki), Some(kd)] = words else {
            let (key, found) = (format!("[gains.{name}.g] {}", joint.get_ref()), format!("{:?}", g.get_ref()));
            let expected = "three integers g from 0 to 65535, a 16 bit word each; gain = g / 2^(16 - s)";
            return Err(document.wrong(&key, g.span(), found, expected));
        };
        by_joint.push((joint.get_ref().clone(), [kp, ki, kd]));
    }
    let mut si = Vec::new();
    for (joint, gains) in &raw.si {
        let key = format!("[gains.{name}.si] {}", joint.get_ref());
        known_joint(document, &key, joint, known)?;
        si.push((joint.get_ref().clone(), triple(document, &key, gains, NOT_NEGATIVE)?.into()));
    }
    Ok(GainSet { name: name.to_owned(), shift: [p, i, d], by_joint, si })
}

/// An effect as it is written; its id and its parameters are the joint layer's to judge.
fn effect(document: &Document<'_>, raw: &RawEffect, known: &dyn Fn(&str) -> bool) -> Result<FileEffect, LogError> {
    let key = |key: &str| format!("[[effect]] {} {key}", raw.id);
    for joint in raw.joints.get_ref() {
        known_joint(document, &key("joints"), joint, known)?;
    }
    let value = |(name, value): (&String, &Number)| {
        Ok((name.clone(), number(document, &key(&format!("parameters.{name}")), value, READING)?))
    };
    Ok(FileEffect {
        id: raw.id.clone(),
        joints: raw.joints.get_ref().iter().map(|joint| joint.get_ref().clone()).collect(),
        parameters: raw.parameters.iter().map(value).collect::<Result<_, LogError>>()?,
    })
}

fn attached(
    document: &Document<'_>,
    raw: &RawAttached,
    is_part: &dyn Fn(&str) -> bool,
) -> Result<FileAttached, LogError> {
    let key = |key: &str| format!("[[attached]] {} {key}", raw.part.get_ref());
    if !is_part(raw.part.get_ref()) {
        let found = format!("\"{}\"", raw.part.get_ref());
        return Err(document.wrong("[[attached]] part", raw.part.span(), found, "the name of a [[part]]"));
    }
    Ok(FileAttached {
        part: raw.part.get_ref().clone(),
        mass_kg: number(document, &key("mass_kg"), &raw.mass_kg, NOT_NEGATIVE)?,
        at_m: triple(document, &key("at_m"), &raw.at_m, PLACE_M)?,
    })
}

fn known_joint(document: &Document<'_>, key: &str, joint: &Text, known: &dyn Fn(&str) -> bool) -> Result<(), LogError> {
    if known(joint.get_ref()) {
        return Ok(());
    }
    Err(document.wrong(key, joint.span(), format!("\"{}\"", joint.get_ref()), "the name or kind of a [[joint]]"))
}

fn encoder(document: &Document<'_>, raw: &RawEncoder) -> Result<EncoderData, LogError> {
    Ok(EncoderData {
        resolution_rad: number(document, "[encoder] resolution_rad", &raw.resolution_rad, NOT_NEGATIVE)?,
        variation_rad: number(document, "[encoder] variation_rad", &raw.variation_rad, NOT_NEGATIVE)?,
        period_s: number(document, "[encoder] period_s", &raw.period_s, POSITIVE)?,
    })
}

fn sensor(document: &Document<'_>, raw: RawSensor) -> Result<SensorRange, LogError> {
    let key = format!("[[sensor]] {} range", raw.name.get_ref());
    let range = raw.range.as_ref().map(|limits| range(document, &key, limits, READING)).transpose()?;
    Ok(SensorRange { name: raw.name.into_inner(), unit: raw.unit, range })
}

fn number(document: &Document<'_>, key: &str, value: &Number, range: Range64) -> Result<f64, LogError> {
    document.within(key, value.span(), *value.get_ref(), range)
}

fn triple(document: &Document<'_>, key: &str, values: &Triple, range: Range64) -> Result<Vector3<f64>, LogError> {
    for value in values.get_ref() {
        document.within(key, values.span(), *value, range)?;
    }
    Ok(Vector3::from(*values.get_ref()))
}

fn metres(document: &Document<'_>, key: &str, mm: &Triple) -> Result<Vector3<f64>, LogError> {
    // Division, not multiplication by 1e-3: 12.5 mm becomes the double nearest to 0.0125.
    Ok(triple(document, key, mm, LENGTH_MM)?.map(|v| v / 1000.0))
}

fn range(
    document: &Document<'_>,
    key: &str,
    limits: &Spanned<[f64; 2]>,
    allowed: Range64,
) -> Result<[f64; 2], LogError> {
    let [low, high] = *limits.get_ref();
    for value in [low, high] {
        document.within(key, limits.span(), value, allowed)?;
    }
    if low < high {
        return Ok([low, high]);
    }
    let found = format!("[{low:?}, {high:?}]");
    Err(document.wrong(key, limits.span(), found, "[least, greatest] with the least below the greatest"))
}
