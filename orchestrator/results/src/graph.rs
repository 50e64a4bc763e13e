//! A picture of units and their connections: boxes on the diagonal, what one gives another in the row of the giver and the
//! column of the taker (an N² chart). So no text covers another, and feedback is what is below the diagonal.

use crate::plot::svg::{Anchor, CURVES, FAINT_INK, INK, Picture, Stroke};

const MARGIN: f64 = 28.0;
/// Between neighbouring boxes.
const GAP: f64 = 30.0;
const LINE_HEIGHT: f64 = 17.0;
const PADDING: f64 = 10.0;
const TEXT: f64 = 12.0;
const HEADING: f64 = 15.0;
/// The mean width of a letter, as a part of its size.
const LETTER: f64 = 0.58;
/// How far lines of the two kinds are apart.
const APART: f64 = 4.0;
/// The most units of measure that one connection shows.
const MEASURES: usize = 3;

/// A unit under its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// The name in the script.
    pub name: String,
    /// The name of the unit.
    pub unit: String,
    /// Its wave and period in words.
    pub when: String,
    /// The wave, which gives the order.
    pub wave: usize,
}

/// A group of connections.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrow {
    /// Index of the node that gives.
    pub from: usize,
    /// Index of the node that takes.
    pub to: usize,
    /// What it gives.
    pub source: String,
    /// What that drives.
    pub target: String,
    /// `=>` instead of `->`.
    pub direct: bool,
    /// The units of measure of the target, each once.
    pub measures: Vec<String>,
}

/// Units and their connections.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Graph {
    /// The title of the script.
    pub title: String,
    /// The units.
    pub nodes: Vec<Node>,
    /// The connections.
    pub arrows: Vec<Arrow>,
}

/// Where the parts are: the middle of each column and row, by place on the diagonal.
struct Layout {
    /// The nodes in the order of the diagonal.
    order: Vec<usize>,
    /// The place of each node.
    place: Vec<usize>,
    x: Vec<f64>,
    y: Vec<f64>,
    width: f64,
    height: f64,
}

impl Graph {
    /// The picture as SVG, the same for equal graphs.
    #[must_use]
    pub fn draw(&self) -> String {
        let layout = self.layout();
        let mut picture = Picture::default();
        picture.text((MARGIN, MARGIN + 6.0), Anchor::Start, 17.0, INK, &self.title);
        for direct in [false, true] {
            for (from, to) in self.pairs() {
                if self.between(from, to).any(|arrow| arrow.direct == direct) {
                    layout.line(&mut picture, self, (from, to), direct);
                }
            }
        }
        for (from, to) in self.pairs() {
            self.card(&mut picture, &layout, from, to);
        }
        for &node in &layout.order {
            self.node(&mut picture, &layout, node);
        }
        let texts = ["->  the value when the step began", "=>  the source steps first, its value when the step ends"];
        let entries = [false, true].map(|direct| (texts[usize::from(direct)].to_owned(), stroke(direct)));
        picture.legend((MARGIN, layout.height - MARGIN + 6.0), &entries);
        picture.finish(&self.title, layout.width, layout.height)
    }

    /// Nodes with at least one arrow from the one to the other, each pair once, in order.
    fn pairs(&self) -> Vec<(usize, usize)> {
        let mut pairs: Vec<_> =
            self.arrows.iter().map(|arrow| (arrow.from, arrow.to)).filter(|(from, to)| from != to).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn between(&self, from: usize, to: usize) -> impl Iterator<Item = &Arrow> {
        self.arrows.iter().filter(move |arrow| (arrow.from, arrow.to) == (from, to))
    }

    /// Width and height of the gap between two nodes.
    fn card_size(&self, from: usize, to: usize) -> (f64, f64) {
        let letters =
            self.between(from, to).map(|arrow| arrow.text().chars().count() + arrow.measure().chars().count() + 2);
        let count = self.between(from, to).count() as f64;
        (LETTER * TEXT * letters.max().unwrap_or(0) as f64 + 2.0 * PADDING, count * LINE_HEIGHT + PADDING)
    }

    fn layout(&self) -> Layout {
        let mut order: Vec<_> = (0..self.nodes.len()).collect();
        order.sort_by_key(|&node| (self.nodes[node].wave, node));
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, &node)| place[node] = at);
        let (mut widths, mut heights): (Vec<f64>, Vec<f64>) = order.iter().map(|&node| self.nodes[node].size()).unzip();
        for (from, to) in self.pairs() {
            let (width, height) = self.card_size(from, to);
            widths[place[to]] = widths[place[to]].max(width);
            heights[place[from]] = heights[place[from]].max(height);
        }
        let middles = |sizes: &[f64], start: f64| {
            let mut end = start;
            let middles = sizes.iter().map(|size| {
                let middle = end + size / 2.0;
                end += size + GAP;
                middle
            });
            (middles.collect::<Vec<_>>(), end - GAP)
        };
        let (x, right) = middles(&widths, MARGIN);
        let (y, bottom) = middles(&heights, 2.0 * MARGIN + 6.0);
        Layout { order, place, x, y, width: (right + MARGIN).max(760.0), height: bottom + 2.0 * MARGIN + 12.0 }
    }

    fn node(&self, picture: &mut Picture, layout: &Layout, node: usize) {
        let (x, y) = layout.middle(node, node);
        let (width, height) = self.nodes[node].size();
        picture.card([x - width / 2.0, y - height / 2.0, width, height], "#eef3f8", "#5b6b7b");
        let Node { name, unit, when, .. } = &self.nodes[node];
        let feeds_itself = self.between(node, node).next().is_some();
        let name = if feeds_itself { format!("{name} (feeds itself)") } else { name.clone() };
        picture.text((x, y - 12.0), Anchor::Middle, HEADING, INK, &name);
        picture.text((x, y + 6.0), Anchor::Middle, TEXT, INK, unit);
        picture.text((x, y + 23.0), Anchor::Middle, TEXT, FAINT_INK, when);
    }

    fn card(&self, picture: &mut Picture, layout: &Layout, from: usize, to: usize) {
        let (x, y) = layout.middle(from, to);
        let (width, height) = self.card_size(from, to);
        let (left, top) = (x - width / 2.0, y - height / 2.0);
        picture.card([left, top, width, height], "#ffffff", "#c9d1d9");
        for (row, arrow) in self.between(from, to).enumerate() {
            let line = top + PADDING / 2.0 + LINE_HEIGHT * (row as f64 + 0.72);
            picture.text((left + PADDING, line), Anchor::Start, TEXT, stroke(arrow.direct).colour, &arrow.text());
            picture.text((left + width - PADDING, line), Anchor::End, TEXT, FAINT_INK, &arrow.measure());
        }
    }
}

impl Node {
    fn size(&self) -> (f64, f64) {
        let width = |text: &str, size: f64| LETTER * size * text.chars().count() as f64;
        let texts = [width(&self.name, HEADING), width(&self.unit, TEXT), width(&self.when, TEXT)];
        (texts.into_iter().fold(90.0, f64::max) + 2.0 * PADDING, 70.0)
    }
}

impl Arrow {
    fn text(&self) -> String {
        format!("{} {} {}", self.source, if self.direct { "=>" } else { "->" }, self.target)
    }

    fn measure(&self) -> String {
        let shown = self.measures.iter().take(MEASURES).cloned().collect::<Vec<_>>().join(", ");
        if self.measures.len() > MEASURES { format!("{shown}, …") } else { shown }
    }
}

impl Layout {
    /// The middle of the cell in the row of one node and the column of another.
    fn middle(&self, row: usize, column: usize) -> (f64, f64) {
        (self.x[self.place[column]], self.y[self.place[row]])
    }

    /// From the side of the giver along its row, then along the column to the taker.
    fn line(&self, picture: &mut Picture, graph: &Graph, (from, to): (usize, usize), direct: bool) {
        let ((x, y), end, start) = (self.middle(from, to), self.middle(to, to), self.middle(from, from));
        let shift = if direct { APART } else { -APART };
        // Rightwards and down above the diagonal, leftwards and up below it.
        let side = if self.place[to] > self.place[from] { 1.0 } else { -1.0 };
        let leaves = start.0 + side * graph.nodes[from].size().0 / 2.0;
        let arrives = end.1 - side * graph.nodes[to].size().1 / 2.0;
        let (x, y) = (x + shift, y + shift);
        picture.curve(&[(leaves, y), (x, y), (x, arrives - side * 7.0)], stroke(direct));
        let tip = [(x, arrives), (x - 4.5, arrives - side * 9.0), (x + 4.5, arrives - side * 9.0)];
        picture.polygon(&tip, stroke(direct).colour, 1.0);
    }
}

/// How arrows of a kind are drawn: `=>` in another colour than `->`.
fn stroke(direct: bool) -> Stroke {
    Stroke::new(CURVES[usize::from(direct)], if direct { 2.0 } else { 1.6 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph() -> Graph {
        let node =
            |name: &str, wave| Node { name: name.to_owned(), unit: "tank".to_owned(), when: String::new(), wave };
        let arrow = |from, to, direct| Arrow {
            from,
            to,
            source: "level".to_owned(),
            target: "<in>".to_owned(),
            direct,
            measures: ["m", "s", "kg", "A"].map(str::to_owned).to_vec(),
        };
        let nodes = vec![node("late", 1), node("early", 0)];
        Graph { title: "Two".to_owned(), nodes, arrows: vec![arrow(0, 1, false), arrow(1, 0, true)] }
    }

    #[test]
    fn units_are_in_the_order_of_their_waves_and_texts_are_escaped() {
        let picture = graph().draw();
        let place = |text: &str| picture.find(text).unwrap();
        assert!(place(">early<") < place(">late<"));
        assert!(picture.contains("level =&gt; &lt;in&gt;") && picture.contains("m, s, kg, …"), "{picture}");
        assert_eq!(picture, graph().draw());
    }

    #[test]
    fn a_script_without_connections_has_a_picture_too() {
        let lonely = Graph { arrows: Vec::new(), ..graph() };
        assert!(lonely.draw().contains(">late<") && Graph::default().draw().ends_with("</svg>\n"));
    }
}
