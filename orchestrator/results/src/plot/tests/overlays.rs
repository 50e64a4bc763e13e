//! What stands on the ground and in space: circles, points, cells, surfaces.

use super::super::mesh::Surface;
use super::super::places::{circles, places};
use super::runs::{run, two_vehicles};
use super::*;

#[test]
fn circles_are_positions_with_a_radius_as_many_as_the_count_says() {
    let found = circles(&two_vehicles(), "world.obstacles").unwrap();
    let radii: Vec<_> = found.iter().map(|circle| (circle.at[0], circle.radius_m)).collect();
    assert_eq!(radii, [(20.0, Some(3.0)), (40.0, Some(4.0))], "the third is beyond `count`");
    assert!(found[1].first != found[1].at, "the second moves");
    for view in [ViewFrom::Above, ViewFrom::Oblique] {
        let group = vec!["world.obstacles".to_owned()];
        let selection = Selection { circles: group, view, ..selecting(&["wing[1].state.position", "together"]) };
        let drawing = picture(&format!("circles-{view:?}"), &[two_vehicles()], &selection);
        assert!(has(&drawing, "world.obstacles"));
    }
    let none = Selection { circles: vec!["wing[1].state".to_owned()], ..Selection::default() };
    let error = draw(vec![two_vehicles()], &none).unwrap_err().to_string();
    assert_eq!(
        error,
        "cannot draw `wing[1].state`: its positions have no `radius` in metres; it has wing[1].state.position.x, \
         wing[1].state.position.y, wing[1].state.position.z"
    );
    let unknown = Selection { circles: vec!["world.obstacle".to_owned()], ..Selection::default() };
    assert_eq!(draw(vec![two_vehicles()], &unknown).unwrap_err(), PlotError::Unknown("world.obstacle".to_owned()));
}

#[test]
fn points_are_positions_in_any_form() {
    let run = run("points", "")
        .along("path.route.point[1]", |_| [0.0, 0.0, 1.0])
        .along("path.route.point[2]", |_| [5.0, 4.0, 1.0])
        .with("cloud.x[1]", "m", |_| 1.0)
        .with("cloud.y[1]", "m", |_| 2.0)
        .with("wind.speed.x", "m/s", |_| 2.0)
        .along("boat.state.position", |t| [t / 3.0, t / 5.0, 0.0]);
    let at = |group: &str| -> Vec<_> { places(&run, group).unwrap().iter().map(|place| place.at).collect() };
    assert_eq!(at("path.route"), [[0.0, 0.0, 1.0], [5.0, 4.0, 1.0]]);
    assert_eq!(at("cloud"), [[1.0, 2.0, 0.0]]);
    let error = places(&run, "wind").unwrap_err().to_string();
    assert_eq!(error, "cannot draw `wind`: it has no x and y in metres; it has wind.speed.x");
    let points = vec!["path.route".to_owned(), "cloud".to_owned()];
    picture("points", &[run], &Selection { points, ..Selection::default() });
}

#[test]
fn a_raster_is_bits_of_words_booleans_or_reals() {
    let run = run("raster", "A map")
        .along("boat.state.position", |t| [t / 2.0, t / 3.0, 0.0])
        .with("map.occupied[1]", "", |_| f64::from(0b1001_0110_0000_1111_i32))
        .of_kind("Integer", &[])
        .with("map.occupied[2]", "", |_| -1.0)
        .of_kind("Integer", &[])
        .with("map.origin.x", "m", |_| 1.0)
        .with("map.origin.y", "m", |_| 2.0)
        .with("map.cell", "m", |_| 0.5);
    let raster = Raster { group: "map.occupied".to_owned(), columns: Some(8), cell_m: None };
    let selection = Selection { rasters: vec![raster.clone()], ..selecting(&["boat.state.position"]) };
    let drawing = picture("raster", std::slice::from_ref(&run), &selection);
    let is_cell =
        |element: &&Element| matches!(element, Element::Area(_, colour, opacity) if *colour == INK && *opacity == 0.45);
    assert_eq!(drawing.picture.elements.iter().filter(is_cell).count(), 1 + 1 + 3 + 4, "runs of cells, and the legend");
    let bare = Raster { columns: None, ..raster };
    let error = draw(vec![run], &Selection { rasters: vec![bare], ..Selection::default() }).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot draw `map.occupied`: no port `columns` is beside it, so say --raster-columns"),
        "{error}"
    );
}

#[test]
fn a_mesh_comes_from_a_file_or_from_ports() {
    let height = |x: i32, y: i32| 4.0 + 3.0 * libm::sin(f64::from(x) / 2.0) * libm::cos(f64::from(y) / 3.0);
    let mut obj = String::new();
    for (x, y) in (0..15).flat_map(|x| (0..15).map(move |y| (x, y))) {
        obj += &format!("v {} {} {}\n", 4 * x, 4 * y, height(x, y));
    }
    for (x, y) in (0..14).flat_map(|x| (0..14).map(move |y| (x, y))) {
        let corner = 1 + 15 * x + y;
        obj += &format!("f {corner} {} {} {}\n", corner + 15, corner + 16, corner + 1);
    }
    let flight = run("terrain", "A flight over hills")
        .along("plane.state.position", |t| [2.5 * t, 5.0 + 2.0 * t, 13.0 + libm::sin(t)])
        .along("tile.point[1]", |_| [0.0; 3])
        .along("tile.point[2]", |_| [9.0, 0.0, 0.0])
        .along("tile.point[3]", |_| [0.0, 9.0, 2.0])
        .with("tile.triangle[1]", "", |_| 1.0)
        .with("tile.triangle[2]", "", |_| 2.0)
        .with("tile.triangle[3]", "", |_| 3.0);
    let mesh = Mesh::Obj(PathBuf::from("hills.obj"), obj);
    let selection = Selection { meshes: vec![mesh], ..selecting(&["plane.state.position"]) };
    picture("mesh", std::slice::from_ref(&flight), &selection);
    assert_eq!(Surface::read(&flight, &Mesh::Ports("tile".to_owned())).unwrap().points.len(), 3);
    let error = Surface::read(&flight, &Mesh::Obj(PathBuf::from("bad.obj"), "v 0 0 0\n".to_owned())).unwrap_err();
    assert_eq!(error.to_string(), "cannot draw `bad.obj`: it has no triangles");
}
