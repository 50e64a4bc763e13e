//! The attribute of one port: the keywords that it may contain, by the role of the port.

use crate::limits;
use proc_macro2::Span;
use syn::ext::IdentExt;
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::{Attribute, Error, Expr, Ident, LitStr, Meta, Result, Token, parenthesized, token};

/// Role of a port in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Input,
    Output,
    Parameter,
    Local,
    /// A group whose fields declare their roles.
    Group,
    /// A field of a group that gets its role where the group is used.
    Port,
}

impl Role {
    const ALL: [(&str, Self); 6] = [
        ("input", Self::Input),
        ("output", Self::Output),
        ("parameter", Self::Parameter),
        ("local", Self::Local),
        ("group", Self::Group),
        ("port", Self::Port),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, role)| *role == self).map_or("", |(name, _)| name)
    }

    /// The keywords that its attribute may contain.
    fn keywords(self) -> &'static [&'static str] {
        match self {
            Self::Input | Self::Port => &["start", "unit", "display", "min", "max", "nominal"],
            Self::Parameter => &["start", "tunable", "unit", "display", "min", "max", "nominal"],
            Self::Output => &["exact", "depends", "init", "unit", "display", "min", "max", "nominal"],
            Self::Local => &["exact", "unit", "display", "min", "max", "nominal"],
            Self::Group => &[],
        }
    }
}

/// One attribute, `#[output(unit = "N", depends(rotor_speed))]`.
pub struct PortAttribute {
    pub role: Role,
    /// Position of the role, for error messages.
    pub span: Span,
    pub tunable: bool,
    pub start: Option<Expr>,
    /// `exact` or `exact = value`.
    pub exact: Option<Option<Expr>>,
    pub depends: Option<Vec<Dependency>>,
    pub depends_at_start: Option<Vec<Dependency>>,
    pub unit: Option<LitStr>,
    pub display: Option<LitStr>,
    pub min: Option<Expr>,
    pub max: Option<Expr>,
    pub nominal: Option<Expr>,
}

/// A port or a part of one, `state.position`.
pub struct Dependency {
    pub path: Vec<Ident>,
}

impl Dependency {
    pub fn name(&self) -> String {
        self.path.iter().map(|ident| ident.unraw().to_string()).collect::<Vec<_>>().join(".")
    }
}

impl PortAttribute {
    /// The port's attribute among those of a field, if it has one.
    pub fn of_field(attributes: &[Attribute]) -> Result<Option<Self>> {
        let mut found: Option<Self> = None;
        for attribute in attributes {
            let role = Role::ALL.iter().find(|(name, _)| attribute.path().is_ident(name));
            let Some(&(name, role)) = role else { continue };
            if let Some(first) = &found {
                let message = format!("a port has one role: this one is `{}` already", first.role.name());
                return Err(Error::new_spanned(attribute, message));
            }
            let span = attribute.path().get_ident().map_or_else(Span::call_site, Ident::span);
            let mut parsed = Self::new(role, span);
            match &attribute.meta {
                Meta::Path(_) => {}
                Meta::List(list) => list.parse_args_with(|input: ParseStream| parsed.read(input))?,
                Meta::NameValue(pair) => return Err(Error::new_spanned(pair, format!("write `#[{name}(..)]`"))),
            }
            parsed.check()?;
            found = Some(parsed);
        }
        Ok(found)
    }

    fn new(role: Role, span: Span) -> Self {
        Self {
            role,
            span,
            tunable: false,
            start: None,
            exact: None,
            depends: None,
            depends_at_start: None,
            unit: None,
            display: None,
            min: None,
            max: None,
            nominal: None,
        }
    }

    fn read(&mut self, input: ParseStream) -> Result<()> {
        let mut seen: Vec<String> = Vec::new();
        while !input.is_empty() {
            let word = input.call(Ident::parse_any)?;
            let name = word.to_string();
            if !self.role.keywords().contains(&name.as_str()) {
                return Err(Error::new(word.span(), self.why_not(&name)));
            }
            if seen.contains(&name) {
                return Err(Error::new(word.span(), format!("`{name}` is given twice")));
            }
            self.read_word(&name, input)?;
            seen.push(name);
            if !input.is_empty() {
                input.parse::<Token![,]>()?;
            }
        }
        Ok(())
    }

    fn read_word(&mut self, name: &str, input: ParseStream) -> Result<()> {
        match name {
            "tunable" => self.tunable = true,
            "start" => self.start = Some(value(input)?),
            "exact" => self.exact = Some(if input.peek(Token![=]) { Some(value(input)?) } else { None }),
            "depends" => self.depends = Some(names(input)?),
            "init" => self.depends_at_start = Some(init(input)?),
            "unit" => self.unit = Some(value(input)?),
            "display" => self.display = Some(value(input)?),
            "min" => self.min = Some(value(input)?),
            "max" => self.max = Some(value(input)?),
            _ => self.nominal = Some(value(input)?),
        }
        Ok(())
    }

    /// Why the attribute of this role does not contain the keyword.
    fn why_not(&self, word: &str) -> String {
        let role = self.role.name();
        match (self.role, word) {
            (Role::Output | Role::Local, "start") => {
                format!("a computed {role} has no start value; a state that starts at one says `exact = ..`")
            }
            (_, "tunable") => "only a parameter can be tunable".to_owned(),
            (Role::Input | Role::Parameter | Role::Port, "exact") => {
                format!("`exact` is for states; the start value of {} is `start = ..`", article(role))
            }
            (_, "depends" | "init") => "only an output says what it depends on".to_owned(),
            (Role::Group, _) => format!("`group` takes nothing: its fields say `{word}`"),
            _ => {
                format!("{} has no attribute `{word}`; it may have {}", article(role), self.role.keywords().join(", "))
            }
        }
    }

    /// Rejects combinations that the standard's table of causality, variability and initial does not allow.
    fn check(&self) -> Result<()> {
        let fail = |message: &str| Err(Error::new(self.span, message));
        match (self.role, &self.exact, &self.depends) {
            (Role::Output, Some(_), Some(_)) => {
                fail("an exact output is a state, which depends on nothing: drop `depends` or `exact`")
            }
            (Role::Output, None, None) => fail(
                "an output needs `depends(..)`, which may be empty, or `exact = ..` for a state with a start value",
            ),
            (Role::Output, Some(_), None) if self.depends_at_start.is_some() => {
                fail("an exact output starts at its value and depends on nothing: drop `init` or `exact`")
            }
            _ if self.display.is_some() && self.unit.is_none() => fail("`display` needs a `unit`"),
            _ => self.check_units().and_then(|()| limits::check(self)),
        }
    }

    fn check_units(&self) -> Result<()> {
        let Some(unit) = &self.unit else { return Ok(()) };
        let base = parse_unit(unit)?;
        let Some(display) = &self.display else { return Ok(()) };
        if parse_unit(display)?.conversion_to(&base).is_none() {
            let message = format!("`{}` and `{}` have different dimensions", display.value(), unit.value());
            return Err(Error::new(display.span(), message));
        }
        Ok(())
    }
}

fn article(role: &str) -> String {
    if role.starts_with(['i', 'o']) { format!("an {role}") } else { format!("a {role}") }
}

fn parse_unit(unit: &LitStr) -> Result<fmi2::units::BaseUnit> {
    fmi2::units::parse(&unit.value()).map_err(|unknown| Error::new(unit.span(), unknown))
}

fn value<T: syn::parse::Parse>(input: ParseStream) -> Result<T> {
    input.parse::<Token![=]>()?;
    input.parse()
}

/// `(a, b.c)`
fn names(input: ParseStream) -> Result<Vec<Dependency>> {
    let content;
    parenthesized!(content in input);
    let one = |input: ParseStream| {
        let path = Punctuated::<Ident, Token![.]>::parse_separated_nonempty_with(input, Ident::parse_any)?;
        Ok(Dependency { path: path.into_iter().collect() })
    };
    Ok(Punctuated::<_, Token![,]>::parse_terminated_with(&content, one)?.into_iter().collect())
}

/// `(depends(a, b))`
fn init(input: ParseStream) -> Result<Vec<Dependency>> {
    if !input.peek(token::Paren) {
        return Err(input.error("write `init(depends(..))`"));
    }
    let content;
    parenthesized!(content in input);
    let word: Ident = content.parse()?;
    if word != "depends" {
        return Err(Error::new(word.span(), "write `init(depends(..))`"));
    }
    names(&content)
}
