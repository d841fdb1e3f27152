'use strict';
// Tables that sort by the heading that is clicked, first from the largest or the start of the alphabet, then the other
// way round; numbers by data-value. Rows without a value stay last.
(function () {
  for (const table of document.querySelectorAll('table.sortable')) {
    const headings = [...table.tHead.rows[0].cells], body = table.tBodies[0];
    const key = (row, column) => {
      const cell = row.cells[column], number = cell.dataset.value ?? '';
      return number !== '' ? Number(number) : cell.classList.contains('num') ? null : cell.textContent;
    };
    headings.forEach((heading, column) => {
      if (heading.textContent === '' || !body.rows[0]?.cells[column].textContent) return;
      const button = document.createElement('button');
      button.type = 'button';
      button.className = 'sort';
      button.append(...heading.childNodes);
      heading.append(button);
      button.addEventListener('click', () => {
        const up = heading.getAttribute('aria-sort') === 'descending' ||
          (heading.getAttribute('aria-sort') !== 'ascending' && !heading.classList.contains('num'));
        headings.forEach((other) => other.removeAttribute('aria-sort'));
        heading.setAttribute('aria-sort', up ? 'ascending' : 'descending');
        const rows = [...body.rows];
        rows.sort((a, b) => {
          const [x, y] = [key(a, column), key(b, column)];
          if (x === null || y === null) return (x === null) - (y === null);
          return (up ? 1 : -1) * (typeof x === 'number' ? x - y : x.localeCompare(y));
        });
        body.append(...rows);
      });
    });
  }
})();
