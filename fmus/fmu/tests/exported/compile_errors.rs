//! Compiler errors of wrong attributes.

#[test]
fn mistakes_in_attributes_are_compile_errors_that_point_at_the_field() {
    trybuild::TestCases::new().compile_fail("tests/ui/*.rs");
}
