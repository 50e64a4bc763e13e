//! The style, shown by examples.

use super::format;
use crate::source::Sources;

/// A script in the style of the language.
fn formatted(script: &str) -> String {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    format(&sources, text).unwrap_or_else(|errors| panic!("{}", crate::diagnostic::render(&sources, &errors, false)))
}

#[test]
fn blanks_around_signs_follow_one_style() {
    for (script, style) in [
        ("step   5ms", "step 5 ms\n"),
        ("let a=[ 1,-2 ,3 ]m/s2", "let a = [1, -2, 3] m/s^2\n"),
        ("let a = max( b.x ,-c[ 1 ] )*2+ - d", "let a = max(b.x, -c[1]) * 2 + -d\n"),
        ("let b = a.{ x,y }", "let b = a.{x, y}\n"),
        ("let b = a[ i+1 ,2 ].c-3", "let b = a[i + 1, 2].c - 3\n"),
        ("for i in 1 .. 3 {\nlet a = 2\n\n}", "for i in 1..3 {\n  let a = 2\n}\n"),
        ("at 3s{set a.x=-1 m}", "at 3 s { set a.x = -1 m }\n"),
        ("fault_x.y->b.u#c", "fault_x.y -> b.u  #c\n"),
        ("at 1 s { fault a.x : noise -5 m,loss 2% }", "at 1 s { fault a.x: noise -5 m, loss 2 % }\n"),
        ("assert a:not(b.x>3 'N.m'and c.ok )", "assert a: not (b.x > 3 'N.m' and c.ok)\n"),
        ("fmu a = \"b\" { }", "fmu a = \"b\" {}\n"),
        ("fmu a = \"b\" {2nd=3,step = 4}", "fmu a = \"b\" { 2nd = 3, step = 4 }\n"),
        ("let a = x==3 m+-1cm", "let a = x == 3 m +- 1 cm\n"),
        ("\r\n\r\nstep 1 s\r\n\r\n\r\n\r\nstop 3 s\r\n\r\n", "step 1 s\n\nstop 3 s\n"),
        ("record a.* , b.x every 20ms", "record a.*, b.x every 20 ms\n"),
        ("\n \t", ""),
    ] {
        assert_eq!(formatted(script), style);
    }
}

#[test]
fn neighbouring_lines_are_aligned_and_others_are_not() {
    let script = "\
param gust=4 m/s # how fast
param longer_name =3 m
let a=3 # why
# alone
let longer = 4

fmu q=\"quadcopter\" {seed=1}
fmu longer = \"wind\" every 5ms {seed = 1} # one
fmu c =\"wind\" every 500 ms {
mean=[
1,2, # x, y
3] m/s
t = 4
}
a.x->b.u
a.longer
  => b.v
a.xy=>b.w,
b.z
at 3 s lasting 10 s {set a.x=3}
at 30 s {set a.x=3}
assert a : always b.x>3
assert longer: b.x >
3
assert ab: min(
b.x,
c.x)>2
";
    insta::assert_snapshot!(formatted(script));
}
