//! `<default>`: classes of attributes.

use super::orientation::ORIENTATIONS;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::{Attribute, Element};
use std::collections::HashMap;

/// The class that everything is in.
const MAIN: &str = "main";
/// Lists whose inherited numbers are replaced one by one.
const LISTS: &[&str] = &["size", "gear", "gainprm", "biasprm", "dynprm"];
/// Attributes that exclude each other: one that is written drops the inherited others.
const EITHER: &[&[&str]] = &[ORIENTATIONS, &["kv", "dampratio"]];
/// The elements that share one default: all kinds of actuators.
pub(super) const ACTUATORS: &[&str] = &[
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "orientation",
    "pid",
];

/// Gains of servos: the default of one kind of actuator is none of another kind's.
const GAINS: &[&str] = &["kp", "kv", "dampratio", "timeconst"];

/// Classes by name.
#[derive(Clone, Debug)]
pub(super) struct Classes(HashMap<String, Class>);

/// Attributes by element.
type Class = HashMap<String, Vec<Attribute>>;

impl Classes {
    /// All sections of a file, in its order.
    pub fn read(root: &Element) -> Result<Self, DescriptionError> {
        let mut classes = Self(HashMap::from([(MAIN.to_owned(), Class::new())]));
        for section in root.all("default") {
            if section.text("class").is_some_and(|class| class != MAIN) {
                return Err(section.bad("class", "main, or nothing: the outermost class has that name"));
            }
            classes.fill(section, MAIN)?;
        }
        Ok(classes)
    }

    /// First what the class says itself, then the classes within it, which begin as copies of it.
    fn fill(&mut self, section: &Element, class: &str) -> Result<(), DescriptionError> {
        let own = self.0.entry(class.to_owned()).or_default();
        for element in section.children.iter().filter(|child| child.tag != "default") {
            let is_actuator = ACTUATORS.contains(&element.tag.as_str());
            let (gains, others): (Vec<Attribute>, Vec<Attribute>) =
                element.attributes.iter().cloned().partition(|one| is_actuator && GAINS.contains(&one.name.as_str()));
            for (kind, attributes) in [(kind(&element.tag).to_owned(), others), (gains_of(&element.tag), gains)] {
                let merged = merged(own.get(&kind).map_or(&[], Vec::as_slice), &attributes);
                own.insert(kind, merged);
            }
        }
        for inner in section.all("default") {
            let name = inner.needed("class")?;
            let copy = self.0.get(class).cloned().unwrap_or_default();
            if self.0.insert(name.to_owned(), copy).is_some() {
                return Err(inner.bad("class", "a name that no other class has"));
            }
            self.fill(inner, name)?;
        }
        Ok(())
    }

    /// That there is a class of this name.
    pub fn check(&self, element: &Element, attribute: &str) -> Result<(), DescriptionError> {
        match element.text(attribute) {
            Some(class) if !self.0.contains_key(class) => Err(element.bad(attribute, "the class of a <default>")),
            _ => Ok(()),
        }
    }

    /// An element with what its class gives it: its own, else the nearest `childclass`, else main.
    pub fn apply(&self, element: &Element, childclass: Option<&str>) -> Result<Element, DescriptionError> {
        self.check(element, "class")?;
        let class = element.text("class").or(childclass).unwrap_or(MAIN);
        let of = |kind: &str| self.0.get(class).and_then(|class| class.get(kind)).map_or(&[][..], Vec::as_slice);
        let inherited = [of(kind(&element.tag)), of(&gains_of(&element.tag))].concat();
        Ok(Element {
            tag: element.tag.clone(),
            foreign: None,
            attributes: merged(&inherited, &element.attributes),
            children: Vec::new(),
            at: element.at.clone(),
        })
    }
}

/// The default that an element shares with others.
fn kind(tag: &str) -> &str {
    if ACTUATORS.contains(&tag) { "general" } else { tag }
}

/// Where the gains of a kind of actuator stand among the attributes of elements.
fn gains_of(tag: &str) -> String {
    format!("gains of {tag}")
}

/// Inherited attributes with others over them.
fn merged(inherited: &[Attribute], own: &[Attribute]) -> Vec<Attribute> {
    let mut all = inherited.to_vec();
    for one in own.iter().filter(|one| one.name != "class") {
        if let Some(others) = EITHER.iter().find(|others| others.contains(&one.name.as_str())) {
            all.retain(|old| old.name == one.name || !others.contains(&old.name.as_str()));
        }
        match all.iter_mut().find(|old| old.name == one.name) {
            Some(old) if LISTS.contains(&one.name.as_str()) => old.value = replaced(&old.value, &one.value),
            Some(old) => old.value.clone_from(&one.value),
            None => all.push(one.clone()),
        }
    }
    all
}

/// The first numbers of a list from another.
fn replaced(inherited: &str, own: &str) -> String {
    let given = own.split_ascii_whitespace().count();
    let kept = inherited.split_ascii_whitespace().skip(given);
    own.split_ascii_whitespace().chain(kept).collect::<Vec<_>>().join(" ")
}
