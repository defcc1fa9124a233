// Draws the figures of a report. The C++ side (figure.h) says what is in a figure; how it looks is decided here.
//
// To add a kind of figure: a function in `options` that turns its specification into an ECharts option.
'use strict';

const root = document.documentElement;
let scriptErrors = 0;
function countError() {
  root.dataset.scriptErrors = String(++scriptErrors);
}
root.dataset.scriptErrors = '0';
window.addEventListener('error', countError);
window.addEventListener('unhandledrejection', countError);
document.addEventListener('securitypolicyviolation', countError);

const ink = '#1f2328';
const fontFamily = getComputedStyle(document.body).fontFamily;

// ---- Samples ----

const decoded = new Map();

// Float64Array; throws where the text is not as many samples as announced.
function samples(index) {
  if (decoded.has(index)) return decoded.get(index);
  const element = document.getElementById('samples-' + index);
  const count = Number(element.dataset.count);
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const width = {f4: 4, f8: 8}[element.dataset.type];
  if (bytes.length !== count * width) {
    throw new Error(`samples ${index}: ${bytes.length} bytes for ${count} samples`);
  }
  const view = new DataView(bytes.buffer);
  const values = new Float64Array(count);
  for (let i = 0; i < count; ++i) {
    values[i] = width === 4 ? view.getFloat32(4 * i, true) : view.getFloat64(8 * i, true);
  }
  decoded.set(index, values);
  return values;
}

// x0 y0 x1 y1 ..., which ECharts takes without making an object of each point.
function interleave(x, y) {
  if (x.length !== y.length) throw new Error('x and y differ in length');
  const points = new Float64Array(2 * x.length);
  for (let i = 0; i < x.length; ++i) {
    points[2 * i] = x[i];
    points[2 * i + 1] = y[i];
  }
  return points;
}

function requireData(values, name) {
  for (const value of values) {
    if (Number.isFinite(value)) return;
  }
  throw new Error('no data in ' + name);
}

// ---- Text ----

function escapeHtml(text) {
  const entity = {'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;', '\'': '&#39;'};
  return text.replace(/[&<>"']/g, (c) => entity[c]);
}

// Five significant digits, as short as they can be written.
function number(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(5))).replace('-', '\u2212') : '\u2013';
}

function tooltipTable(heading, rows) {
  const cells = rows.map(([color, name, value]) =>
    `<tr style="background:none"><td style="padding:0 6px 0 0;border:0"><span style="color:${color}">\u25cf</span> ` +
    `${escapeHtml(name)}</td><td style="padding:0;border:0;text-align:right">${escapeHtml(value)}</td></tr>`);
  return `<b>${escapeHtml(heading)}</b><table style="font-size:12px">${cells.join('')}</table>`;
}

// ---- What all figures share ----

// Rows that a legend takes in a figure of half the page's width, where it shares its line with the toolbox.
function legendRows(names) {
  let rows = 1;
  let used = 0;
  for (const name of names) {
    const width = 30 + 6.8 * name.length;
    if (used > 0 && used + width > 560) {
      ++rows;
      used = 0;
    }
    used += width;
  }
  return rows;
}

function base(spec, names = spec.series.map((s) => s.name)) {
  return {
    animation: false,
    textStyle: {fontFamily, color: ink, fontSize: 12},
    color: spec.series.map((s) => s.color),
    legend: {
      top: 0, left: 8, itemWidth: 14, itemHeight: 8, itemGap: 8, icon: spec.kind === 'time' ? 'roundRect' : undefined,
      textStyle: {color: ink, fontSize: 12}, data: names,
    },
    tooltip: {confine: true, textStyle: {color: ink, fontSize: 12}, padding: [4, 8]},
    toolbox: {
      right: 6, top: -12, itemSize: 13, feature: {saveAsImage: {title: 'save', name: spec.title, pixelRatio: 2}},
    },
    grid: {left: 14, right: 16, top: 14 + 20 * legendRows(names), bottom: 10, outerBoundsMode: 'same', outerBoundsContain: 'all'},
  };
}

function axis(type, title, more) {
  return {
    type, name: title, nameLocation: 'middle', nameGap: 28, nameTextStyle: {color: ink, fontSize: 13},
    axisLine: {show: true, lineStyle: {color: ink}, onZero: false},
    axisTick: {show: true, lineStyle: {color: ink}},
    axisLabel: {color: ink, fontSize: 12, hideOverlap: true, formatter: type === 'value' ? number : undefined},
    splitLine: {show: type === 'value', lineStyle: {color: '#e3e7eb'}},
    ...more,
  };
}

function valueAxis(title, more) {
  return axis('value', title, {scale: true, ...more});
}

// Index of the entry of the increasing t that is nearest to x.
function nearest(t, x) {
  let low = 0;
  let high = t.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= x) low = middle; else high = middle;
  }
  return x - t[low] <= t[high] - x ? low : high;
}

// A band of expected values with its line, along one axis: the markers of a series that carries nothing else.
function bandMarks(band, key) {
  return {
    markArea: {
      silent: true, itemStyle: {color: 'rgba(31, 35, 40, 0.10)'}, data: [[{[key]: band.lower}, {[key]: band.upper}]],
    },
    markLine: {
      silent: true, symbol: 'none', lineStyle: {color: ink, type: 'dashed', width: 1},
      label: {formatter: () => band.name, color: ink, fontSize: 11, position: 'end', distance: 4}, data: [{[key]: band.value}],
    },
  };
}

// ---- Kinds of figures ----

// First and last time over all figures of a link, so that equal zooms are equal times.
function timeRange(spec, specs) {
  const linked = spec.link ? specs.filter((s) => s.kind === 'time' && s.link === spec.link) : [spec];
  const ends = linked.map((s) => samples(s.t)).filter((t) => t.length > 0);
  return {min: Math.min(...ends.map((t) => t[0])), max: Math.max(...ends.map((t) => t[t.length - 1]))};
}

const options = {
  time(spec, specs) {
    const t = samples(spec.t);
    const values = spec.series.map((s) => samples(s.samples));
    values.forEach((v, i) => requireData(v, spec.series[i].name));
    const option = base(spec);
    option.tooltip.trigger = 'axis';
    // Not what ECharts passes, which is what its sampling left on the screen: the samples nearest to the pointer.
    option.tooltip.formatter = (hits) => {
      const i = nearest(t, hits[0].axisValue);
      return tooltipTable(`t = ${t[i].toFixed(4)} s`,
        spec.series.map((s, k) => [s.color, s.name, number(values[k][i])]));
    };
    option.toolbox.feature = {
      dataZoom: {yAxisIndex: 'none', title: {zoom: 'zoom', back: 'back'}}, ...option.toolbox.feature};
    option.xAxis = valueAxis('time [s]', timeRange(spec, specs));
    option.yAxis = valueAxis(spec.yTitle, {nameGap: 40});
    option.grid.bottom = 34;
    option.dataZoom = [
      {type: 'inside', zoomOnMouseWheel: 'ctrl'},
      {type: 'slider', height: 16, bottom: 6, showDataShadow: false, showDetail: false, brushSelect: false,
        backgroundColor: '#eef1f3', fillerColor: 'rgba(0, 90, 143, 0.18)', borderColor: '#c4cad0',
        handleStyle: {borderColor: '#57606a'}, handleSize: '120%'},
    ];
    option.series = spec.series.map((s, k) => ({
      type: 'line', name: s.name, data: interleave(t, values[k]), showSymbol: false, sampling: 'minmax',
      lineStyle: {width: 1.2}, emphasis: {disabled: true},
    }));
    return option;
  },

  scatter(spec) {
    const option = base(spec);
    option.tooltip.formatter = (hit) => tooltipTable(hit.name ? `${hit.seriesName}: ${hit.name}` : hit.seriesName, [
      ...(spec.categories ? [] : [[hit.color, spec.xTitle, number(hit.value[0])]]),
      [hit.color, spec.yTitle, number(hit.value[1])]]);
    option.toolbox.feature = {
      dataZoom: {title: {zoom: 'zoom', back: 'back'}}, ...option.toolbox.feature};
    const log = spec.logarithmic ? {type: 'log', minorSplitLine: {show: false}} : {};
    option.xAxis = valueAxis(spec.xTitle, log);
    option.yAxis = valueAxis(spec.yTitle, {nameGap: 40, ...log});
    if (spec.categories) {
      Object.assign(option.xAxis, {
        min: -0.5, max: spec.categories.length - 0.5, interval: 0.5, splitLine: {show: false}, axisTick: {show: false}});
      // Ticks at halves, so that the whole numbers are among them whatever the ends.
      option.xAxis.axisLabel = {...option.xAxis.axisLabel, hideOverlap: false,
        formatter: (x) => (Number.isInteger(x) ? spec.categories[x] ?? '' : '')};
    }
    option.dataZoom = [
      {type: 'inside', xAxisIndex: 0, filterMode: 'none', zoomOnMouseWheel: 'ctrl'},
      {type: 'inside', yAxisIndex: 0, filterMode: 'none', zoomOnMouseWheel: 'ctrl'},
    ];
    const drawable = (x, y) => Number.isFinite(x) && Number.isFinite(y) && (!spec.logarithmic || (x > 0 && y > 0));
    const seen = [];
    option.series = spec.series.map((s) => {
      const x = samples(s.x);
      const y = samples(s.y);
      requireData(y, s.name);
      if (spec.rays) for (let i = 0; i < x.length; ++i) if (drawable(x[i], y[i])) seen.push(x[i]);
      if (!s.labels && !spec.logarithmic) {
        return {
          type: 'scatter', name: s.name, data: interleave(x, y), large: true, largeThreshold: 2000,
          progressive: 0, symbolSize: s.size ?? (y.length > 2000 ? 2 : 5), itemStyle: {opacity: y.length > 2000 ? 0.45 : 0.8},
        };
      }
      const points = [];
      for (let i = 0; i < x.length; ++i) {
        if (drawable(x[i], y[i])) points.push({name: s.labels ? s.labels[i] : '', value: [x[i], y[i]]});
      }
      return {
        type: 'scatter', name: s.name, data: points, symbolSize: s.size ?? (spec.showLabels ? 8 : 5), itemStyle: {opacity: 0.8},
        label: {show: Boolean(spec.showLabels), formatter: '{b}', position: 'right', distance: 3, color: ink, fontSize: 10},
        labelLayout: {hideOverlap: true},
      };
    });
    if (spec.band) {
      Object.assign(option.series[0], bandMarks(spec.band, 'yAxis'));
      option.grid.right = 44;
    }
    // Over as many decades as the points take.
    const ends = [10 ** Math.floor(Math.log10(Math.min(...seen))), 10 ** Math.ceil(Math.log10(Math.max(...seen)))];
    for (const ray of (seen.length > 0 && spec.rays) || []) {
      const label = {show: true, formatter: () => ray.name, color: ink, fontSize: 11, position: 'right', offset: [2, 9]};
      option.series.push({
        type: 'line', silent: true, z: 1, symbol: 'circle', symbolSize: 1, color: ink, emphasis: {disabled: true},
        data: ends.map((x, i) => ({value: [x, ray.slope * x], label: i === 0 ? label : {show: false}})),
        lineStyle: {color: ink, type: 'dashed', width: 1}, tooltip: {show: false},
      });
    }
    return option;
  },

  interval(spec) {
    const option = base(spec);
    const names = axis('category', '', {
      data: spec.parameters, axisTick: {show: false}, splitLine: {show: true, lineStyle: {color: '#eef1f3'}},
      axisLabel: {color: ink, fontSize: 12, interval: 0}, inverse: !spec.vertical,
    });
    const [min, max] = spec.limits || [undefined, undefined];
    const values = valueAxis(spec.valueTitle, {min, max, nameGap: spec.vertical ? 40 : 28});
    [option.xAxis, option.yAxis] = spec.vertical ? [names, values] : [values, names];
    option.tooltip.formatter = (hit) => {
      const s = spec.series[hit.seriesIndex];
      const i = hit.value[0];
      return tooltipTable(spec.parameters[i], [
        [hit.color, s.name, number(s.value[i] ?? NaN)],
        [hit.color, 'interval', `${number(s.lower[i] ?? NaN)} to ${number(s.upper[i] ?? NaN)}`]]);
    };
    const scaled = (array, i) => (array[i] === null || !spec.unit[i] ? NaN : array[i] / spec.unit[i]);
    const zero = {
      silent: true, symbol: 'none', label: {show: false}, lineStyle: {color: ink, type: 'dashed', width: 1},
      data: [spec.vertical ? {yAxis: 0} : {xAxis: 0}],
    };
    option.series = spec.series.map((s, k) => {
      requireData(s.value.map((v) => v ?? NaN), s.name);
      return {
        ...(k > 0 ? {} : spec.band ? bandMarks(spec.band, spec.vertical ? 'yAxis' : 'xAxis') : {markLine: zero}),
        type: 'custom', name: s.name, renderItem: intervalItem(k, spec), clip: true,
        data: spec.parameters.map((_, i) => [i, scaled(s.value, i), scaled(s.lower, i), scaled(s.upper, i)]),
        encode: spec.vertical ? {x: 0, y: [1, 2, 3]} : {x: [1, 2, 3], y: 0},
      };
    });
    return option;
  },

  bar(spec) {
    const option = base(spec);
    option.tooltip.trigger = 'axis';
    option.tooltip.axisPointer = {type: 'shadow'};
    option.tooltip.formatter = (hits) => tooltipTable(hits[0].axisValueLabel,
      hits.map((hit) => [hit.color, hit.seriesName, number(hit.value ?? NaN)]));
    option.xAxis = axis('category', spec.xTitle, {data: spec.categories});
    option.yAxis = valueAxis(spec.yTitle, {scale: false, nameGap: 40});
    option.series = spec.series.map((s) => {
      requireData(s.value.map((v) => v ?? NaN), s.name);
      return {
        type: 'bar', name: s.name, data: s.value, barMaxWidth: 42,
        label: {show: true, position: 'top', color: ink, fontSize: 11,
          formatter: (hit) => (hit.value === null ? '' : String(Number(hit.value.toPrecision(3))))},
        labelLayout: {hideOverlap: true},
      };
    });
    return option;
  },

  histogram(spec) {
    const title = (s) => {
      const share = 100 * s.beyond / s.count;
      return s.beyond > 0 ? `${s.name} (${share < 1 ? '<1' : share.toFixed(0)} % beyond)` : s.name;
    };
    const option = base(spec, spec.series.map(title));
    const edge = (i) => spec.lower + i * spec.width;
    const bins = spec.series[0].percent.length;
    option.tooltip.trigger = 'axis';
    option.tooltip.formatter = (hits) => {
      const i = Math.min(Math.max(Math.floor((hits[0].axisValue - spec.lower) / spec.width), 0), bins - 1);
      return tooltipTable(`${number(edge(i))} to ${number(edge(i + 1))}`,
        spec.series.map((s) => [s.color, s.name, number(s.percent[i]) + ' %']));
    };
    option.xAxis = valueAxis(spec.xTitle, {min: edge(0), max: edge(bins), splitLine: {show: false},
      axisLabel: {color: ink, fontSize: 12, hideOverlap: true, formatter: number, showMinLabel: false,
        showMaxLabel: false}});
    option.yAxis = valueAxis('share [%]', {scale: false, min: 0, nameGap: 40});
    // A step holds until the next edge; down to zero at both ends.
    const steps = (percent) => [
      [edge(0), 0], ...percent.map((p, i) => [edge(i), p]), [edge(bins), percent[bins - 1]], [edge(bins), 0]];
    const line = {type: 'line', step: 'end', showSymbol: false, emphasis: {disabled: true}};
    option.series = spec.series.map((s, k) => {
      if (s.count === 0) throw new Error('no data in ' + s.name);
      const mark = {
        silent: true, symbol: 'none', lineStyle: {color: ink, type: 'dashed', width: 1.2},
        label: {formatter: () => spec.mark.name, color: ink, fontSize: 11, position: 'end', distance: 3},
        data: spec.mark && [{xAxis: spec.mark.value}],
      };
      return {
        ...line, name: title(s), data: steps(s.percent), lineStyle: {width: 1.4}, areaStyle: {opacity: 0.12},
        markLine: spec.mark && k === 0 ? mark : undefined,
      };
    });
    if (spec.expected) {
      option.series.push({...line, data: steps(spec.expected), silent: true, color: ink,
        lineStyle: {color: ink, type: 'dashed', width: 1.2}});
    }
    return option;
  },
};

// Dot, whisker and caps of one row; an arrow at the edge where the axis ends before the value.
function intervalItem(set, spec) {
  return (params, api) => {
    const row = api.value(0);
    const band = spec.vertical ? api.size([1, 0])[0] : api.size([0, 1])[1];
    const shift = (set - (spec.series.length - 1) / 2) * band * 0.7 / spec.series.length;
    const area = params.coordSys;
    const [from, to] = spec.vertical ? [area.y, area.y + area.height] : [area.x, area.x + area.width];
    // Along: pixels along the value axis. Across: the row's middle.
    const along = (value) => (spec.vertical ? api.coord([row, value])[1] : api.coord([value, row])[0]);
    const across = (spec.vertical ? api.coord([row, 0])[0] : api.coord([0, row])[1]) + shift;
    const point = (a, b) => (spec.vertical ? [b, a] : [a, b]);
    const inside = (a) => Math.min(Math.max(a, from), to);
    const color = api.visual('color');
    const children = [];
    const line = (a1, b1, a2, b2) => {
      const [x1, y1] = point(a1, b1);
      const [x2, y2] = point(a2, b2);
      children.push({type: 'line', shape: {x1, y1, x2, y2}, style: {stroke: color, lineWidth: 1.6}});
    };
    const arrow = (edge) => {
      const back = edge + (edge === from ? 8 : -8);
      children.push({type: 'polygon', style: {fill: color},
        shape: {points: [point(edge, across), point(back, across - 4), point(back, across + 4)]}});
    };
    const centre = along(api.value(1));
    const ends = [along(api.value(2)), along(api.value(3))];
    if (ends.every(Number.isFinite)) {
      line(inside(ends[0]), across, inside(ends[1]), across);
      for (const end of ends) {
        if (end === inside(end)) line(end, across - 3.5, end, across + 3.5); else arrow(inside(end));
      }
    }
    if (Number.isFinite(centre)) {
      const [cx, cy] = point(centre, across);
      if (centre !== inside(centre)) arrow(inside(centre));
      else children.push({type: 'circle', shape: {cx, cy, r: 3.2}, style: {fill: color}});
    }
    return {type: 'group', children};
  };
}

// ---- Drawing ----

// Whether pixels of a series' colour, paler where lines are thin, stand in the plotting area.
function seriesSeen(chart, spec) {
  const area = chart.getModel().getComponent('grid').coordinateSystem.getRect();
  const ratio = chart.getDevicePixelRatio();
  const box = [area.x * ratio + 2, area.y * ratio + 2, area.width * ratio - 4, area.height * ratio - 4];
  // Darkness by channel on white paper.
  const targets = spec.series.map((s) => [1, 3, 5].map((i) => 255 - parseInt(s.color.slice(i, i + 2), 16)));
  const isTarget = (r, g, b) => targets.some((target) => {
    const cosine = (r * target[0] + g * target[1] + b * target[2]) / (Math.hypot(r, g, b) * Math.hypot(...target));
    return cosine > 0.98 && Math.hypot(r, g, b) > 0.25 * Math.hypot(...target);
  });
  // ECharts puts large scatters on a canvas of their own.
  return [...chart.getDom().querySelectorAll('canvas')].some((canvas) => {
    const {data} = canvas.getContext('2d').getImageData(...box);
    for (let i = 0; i < data.length; i += 4) {
      const alpha = data[i + 3] / 255;
      if (alpha > 0 && isTarget((255 - data[i]) * alpha, (255 - data[i + 1]) * alpha, (255 - data[i + 2]) * alpha)) {
        return true;
      }
    }
    return false;
  });
}

const charts = [];

// Paper is narrower than a screen, and no frame is drawn between this event and the print.
window.addEventListener('beforeprint', () => {
  root.classList.add('printing');
  for (const chart of charts) {
    chart.resize();
    chart.getZr().flush();
  }
});
window.addEventListener('afterprint', () => root.classList.remove('printing'));

function draw(element, spec, specs) {
  return new Promise((resolve, reject) => {
    const option = options[spec.kind](spec, specs);
    if (option.series.length === 0) throw new Error('no series');
    const chart = echarts.init(element);
    chart.on('finished', () => {
      chart.off('finished');
      const empty = chart.getModel().getSeries().filter((series) => series.getData().count() === 0);
      if (empty.length > 0 || (location.hash === '#check' && !seriesSeen(chart, spec))) {
        reject(new Error('nothing drawn in ' + spec.title));
      } else {
        element.dataset.drawn = 'true';
        resolve();
      }
    });
    chart.setOption(option);
    if (option.dataZoom) {
      // Dragging zooms from the start, without a press on the toolbox.
      chart.dispatchAction({type: 'takeGlobalCursor', key: 'dataZoomSelect', dataZoomSelectActive: true});
      chart.getZr().on('dblclick', () => chart.dispatchAction(
        {type: 'dataZoom', batch: option.dataZoom.map((_, i) => ({dataZoomIndex: i, start: 0, end: 100}))}));
    }
    if (spec.link) {
      chart.group = spec.link;
      echarts.connect(spec.link);
    }
    // ECharts swallows every turn of the wheel, also those it does not zoom by: leave these to the page.
    element.addEventListener('wheel', (event) => event.ctrlKey || event.stopPropagation(), {capture: true});
    new ResizeObserver(() => chart.resize()).observe(element);
    charts.push(chart);
  });
}

async function drawAll() {
  const specs = JSON.parse(document.getElementById('figure-specs').textContent);
  root.dataset.figuresExpected = String(specs.length);
  let drawn = 0;
  // One after the other: the page can be read and scrolled while the lower figures are still to come.
  for (const [i, spec] of specs.entries()) {
    const element = document.getElementById('figure-' + i);
    try {
      await draw(element, spec, specs);
      ++drawn;
    } catch (error) {
      countError();
      console.error(spec.title, error);
      element.classList.add('failed');
      element.append('This figure could not be drawn: ' + error.message);
    }
  }
  root.dataset.figuresDrawn = String(drawn);
}

drawAll();
