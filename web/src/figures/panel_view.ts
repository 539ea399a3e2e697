/** Interface of a figure's panels. */
export interface PanelView {
  readonly element: HTMLElement;
  setWidth(width: number): void;
  /** Shows the time of a row. */
  showRow(row: number): void;
  /** Redraws with the current colours of the page. */
  paint(): void;
  /** Redraws with the current rows. */
  refresh(): void;
}
