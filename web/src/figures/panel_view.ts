/** What a figure asks of each of its panels. */
export interface PanelView {
  readonly element: HTMLElement;
  setWidth(width: number): void;
  /** Shows the moment of a row. */
  showRow(row: number): void;
  /** Takes the page's colours as they are now. */
  paint(): void;
  /** Takes the rows as they are now. */
  refresh(): void;
}
