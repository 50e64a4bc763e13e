//! A unit's description with its names in order, so that a look-up does not search through all of it.

use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::Arc;

use fmi2::description::{Item, Kind, Limits, ModelDescription, TypeKind, UnitDefinition, Unknown};
use fmi2::units::BaseUnit;

/// A description and the order of its names. Of equal names the first one counts.
#[derive(Debug)]
pub(super) struct Unit {
    description: Arc<ModelDescription>,
    /// The variables in order of their names.
    order: Vec<usize>,
    unit_index: BTreeMap<String, usize>,
    type_index: BTreeMap<String, usize>,
    /// The initial unknowns by their variables.
    unknown_index: BTreeMap<usize, usize>,
}

impl Deref for Unit {
    type Target = ModelDescription;

    fn deref(&self) -> &ModelDescription {
        &self.description
    }
}

/// The index of each name, of equal names that of the first.
fn first_by<K: Ord>(keys: impl DoubleEndedIterator<Item = K> + ExactSizeIterator) -> BTreeMap<K, usize> {
    keys.enumerate().rev().map(|(index, key)| (key, index)).collect()
}

impl Unit {
    /// Puts the names of a description in order.
    pub fn new(description: Arc<ModelDescription>) -> Self {
        let mut order: Vec<usize> = (0..description.variables.len()).collect();
        order.sort_by_key(|&variable| (description.variables[variable].name.as_str(), variable));
        Self {
            order,
            unit_index: first_by(description.units.iter().map(|unit| unit.name.clone())),
            type_index: first_by(description.types.iter().map(|declared| declared.name.clone())),
            unknown_index: first_by(description.structure.initial_unknowns.iter().map(|unknown| unknown.index)),
            description,
        }
    }

    fn name(&self, variable: usize) -> &str {
        &self.description.variables[variable].name
    }

    /// The variables whose names begin so, in order of their names.
    pub fn beginning(&self, with: &str) -> &[usize] {
        let first = self.order.partition_point(|&variable| self.name(variable) < with);
        let after = &self.order[first..];
        &after[..after.partition_point(|&variable| self.name(variable).starts_with(with))]
    }

    /// The variable of a name.
    pub fn variable(&self, name: &str) -> Option<usize> {
        self.beginning(name).first().copied().filter(|&variable| self.name(variable) == name)
    }

    /// The variables of a group or array: what follows its name, with the variable, in the description's order.
    pub fn members(&self, of: &str) -> Vec<(String, usize)> {
        let parts = [".", "["].map(|separator| self.beginning(&format!("{of}{separator}")));
        let mut members = parts.concat();
        members.sort_unstable();
        members.into_iter().map(|variable| (self.name(variable)[of.len()..].to_owned(), variable)).collect()
    }

    /// Whether a variable, group or array has this name.
    pub fn has(&self, name: &str) -> bool {
        self.variable(name).is_some()
            || [".", "["].iter().any(|separator| !self.beginning(&format!("{name}{separator}")).is_empty())
    }

    /// As [`ModelDescription::unit`].
    pub fn unit(&self, name: &str) -> Option<&UnitDefinition> {
        self.unit_index.get(name).map(|&unit| &self.description.units[unit])
    }

    fn declared_type(&self, variable: usize) -> Option<&TypeKind> {
        let declared = self.type_index.get(self.description.variables[variable].declared_type.as_deref()?)?;
        Some(&self.description.types[*declared].kind)
    }

    /// As [`ModelDescription::unit_of`].
    pub fn unit_of(&self, variable: usize) -> Option<&str> {
        let Kind::Real(own) = &self.description.variables[variable].kind else { return None };
        own.unit.as_deref().or_else(|| match self.declared_type(variable)? {
            TypeKind::Real(real) => real.unit.as_deref(),
            _ => None,
        })
    }

    /// Whether the values of a variable are differences.
    pub fn is_relative(&self, variable: usize) -> bool {
        let Kind::Real(own) = &self.description.variables[variable].kind else { return false };
        let inherited = || match self.declared_type(variable) {
            Some(TypeKind::Real(real)) => real.relative_quantity,
            _ => None,
        };
        own.relative_quantity.or_else(inherited).unwrap_or(false)
    }

    fn defined_base(&self, variable: usize) -> Option<BaseUnit> {
        self.unit(self.unit_of(variable)?)?.base
    }

    /// What the unit of measure of a variable is defined as; a difference has no offset.
    pub fn base_of(&self, variable: usize) -> Option<BaseUnit> {
        let base = self.defined_base(variable)?;
        Some(if self.is_relative(variable) { BaseUnit { offset: 0.0, ..base } } else { base })
    }

    /// Whether the unit of measure of a variable is defined with an offset, which does not apply to differences.
    pub fn has_offset(&self, variable: usize) -> bool {
        self.defined_base(variable).is_some_and(|base| base.offset != 0.0)
    }

    /// As [`ModelDescription::limits_of`].
    pub fn limits_of(&self, variable: usize) -> Limits {
        Limits::of(&self.description.variables[variable], self.declared_type(variable))
    }

    /// As [`ModelDescription::items_of`].
    pub fn items_of(&self, variable: usize) -> &[Item] {
        match self.declared_type(variable) {
            Some(TypeKind::Enumeration { items, .. }) => items,
            _ => &[],
        }
    }

    /// What the description says about the initial value of a variable.
    pub fn initial_unknown(&self, variable: usize) -> Option<&Unknown> {
        self.unknown_index.get(&variable).map(|&unknown| &self.description.structure.initial_unknowns[unknown])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi2::description::read::read;

    fn unit() -> Unit {
        let names = [("b.y", "m"), ("b_y", "m"), ("b[2]", "m"), ("b.x", "m"), ("b", "m"), ("b.x", "kg"), ("bc", "m")];
        let variable = |(index, (name, unit)): (usize, &(&str, &str))| {
            format!(
                "<ScalarVariable name='{name}' valueReference='{index}' causality='output'><Real unit='{unit}'/></ScalarVariable>"
            )
        };
        let variables: String = names.iter().enumerate().map(variable).collect();
        let text = format!(
            "<fmiModelDescription fmiVersion='2.0' modelName='names' guid='g'><CoSimulation modelIdentifier='names'/>\
             <ModelVariables>{variables}</ModelVariables><ModelStructure/></fmiModelDescription>"
        );
        let (description, _) = read(text.as_bytes()).expect("a description");
        Unit::new(Arc::new(description))
    }

    #[test]
    fn a_group_has_its_members_in_the_order_of_the_description() {
        let members = unit().members("b");
        let members: Vec<_> = members.iter().map(|(name, variable)| (name.as_str(), *variable)).collect();
        assert_eq!(members, [(".y", 0), ("[2]", 2), (".x", 3), (".x", 5)]);
    }

    #[test]
    fn of_equal_names_the_first_one_counts() {
        assert_eq!(unit().variable("b.x"), Some(3));
        assert_eq!(unit().variable("b"), Some(4));
        assert_eq!(unit().unit_of(5), Some("kg"));
    }

    #[test]
    fn a_beginning_is_a_name_only_in_front_of_a_point_or_a_bracket() {
        let unit = unit();
        assert!(unit.has("b") && unit.has("b.x") && unit.has("bc"));
        assert!(!unit.has("b.") && !unit.has("c") && !unit.has("b_") && !unit.has(""));
    }
}
