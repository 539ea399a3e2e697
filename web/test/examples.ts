/** Pages of each kind, as feeler-report makes them; its test `page_contract` wrote this. */
import type { PageData } from "../src/page_data";

export const examples: PageData[] = [
  {
    "figures": [
      {
        "columns": 1,
        "number": 8,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/grasp_force"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/grasp_force"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "grasp threshold",
                "value": 1.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Grasp force",
              "log": false,
              "range": [
                0.0,
                2.875
              ],
              "scale": 1.0,
              "unit": "N"
            }
          },
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "shared",
                "column": {
                  "index": 0,
                  "name": "torque"
                },
                "line": "solid",
                "name": "torque"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Torque",
              "log": false,
              "scale": 1000.0,
              "unit": "mN·m"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 9,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/shear_rate"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/shear_rate"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "slip threshold",
                "value": 3.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Shear rate",
              "log": false,
              "range": [
                0.0,
                30.76
              ],
              "scale": 1.0,
              "unit": "N/s"
            }
          },
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "shared",
                "column": {
                  "index": 0,
                  "name": "torque"
                },
                "line": "solid",
                "name": "torque"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Torque",
              "log": false,
              "scale": 1000.0,
              "unit": "mN·m"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 10,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "rows": [
              0,
              300
            ],
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/shear_rate"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/shear_rate"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "slip threshold",
                "value": 3.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Shear rate",
              "log": false,
              "range": [
                0.0,
                30.76
              ],
              "scale": 1.0,
              "unit": "N/s"
            }
          },
          {
            "equal": false,
            "kind": "time",
            "rows": [
              0,
              300
            ],
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "bit": 1,
                  "index": 0,
                  "name": "finger/0/flags"
                },
                "line": "states",
                "name": "SLIP, finger 0"
              },
              {
                "colour": "shared",
                "column": {
                  "bit": 3,
                  "index": 0,
                  "name": "finger/0/flags"
                },
                "line": "states",
                "name": "true slip, finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "bit": 1,
                  "index": 0,
                  "name": "finger/1/flags"
                },
                "line": "states",
                "name": "SLIP, finger 1"
              },
              {
                "colour": "shared",
                "column": {
                  "bit": 3,
                  "index": 0,
                  "name": "finger/1/flags"
                },
                "line": "states",
                "name": "true slip, finger 1"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Slip",
              "log": false,
              "scale": 1.0,
              "unit": ""
            }
          },
          {
            "equal": false,
            "kind": "time",
            "rows": [
              0,
              300
            ],
            "series": [
              {
                "colour": "shared",
                "column": {
                  "index": 0,
                  "name": "torque"
                },
                "line": "solid",
                "name": "torque"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Torque",
              "log": false,
              "scale": 1000.0,
              "unit": "mN·m"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 11,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "rows": [
              900,
              1200
            ],
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/shear_rate"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/shear_rate"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "slip threshold",
                "value": 3.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Shear rate",
              "log": false,
              "range": [
                0.0,
                30.76
              ],
              "scale": 1.0,
              "unit": "N/s"
            }
          },
          {
            "equal": false,
            "kind": "time",
            "rows": [
              900,
              1200
            ],
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "bit": 1,
                  "index": 0,
                  "name": "finger/0/flags"
                },
                "line": "states",
                "name": "SLIP, finger 0"
              },
              {
                "colour": "shared",
                "column": {
                  "bit": 3,
                  "index": 0,
                  "name": "finger/0/flags"
                },
                "line": "states",
                "name": "true slip, finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "bit": 1,
                  "index": 0,
                  "name": "finger/1/flags"
                },
                "line": "states",
                "name": "SLIP, finger 1"
              },
              {
                "colour": "shared",
                "column": {
                  "bit": 3,
                  "index": 0,
                  "name": "finger/1/flags"
                },
                "line": "states",
                "name": "true slip, finger 1"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Slip",
              "log": false,
              "scale": 1.0,
              "unit": ""
            }
          },
          {
            "equal": false,
            "kind": "time",
            "rows": [
              900,
              1200
            ],
            "series": [
              {
                "colour": "shared",
                "column": {
                  "index": 0,
                  "name": "torque"
                },
                "line": "solid",
                "name": "torque"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Torque",
              "log": false,
              "scale": 1000.0,
              "unit": "mN·m"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 12,
        "panels": [
          {
            "equal": true,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "finger 0",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0333,
                    0.0333,
                    0.0333,
                    0.0333
                  ],
                  "y": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "planned line, finger 0",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.03329,
                    0.03329,
                    0.03329,
                    0.03329
                  ],
                  "y": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "solid",
                "name": "finger 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    -0.0333,
                    -0.0333,
                    -0.0333,
                    -0.0333
                  ],
                  "y": [
                    0.0,
                    -0.0001,
                    -0.0002,
                    -0.0003
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "planned line, finger 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    -0.03329,
                    -0.03329,
                    -0.03329,
                    -0.03329
                  ],
                  "y": [
                    0.0,
                    -0.0001,
                    -0.0002,
                    -0.0003
                  ]
                }
              },
              {
                "colour": "shared",
                "line": "solid",
                "name": "cap",
                "points": {
                  "x": [
                    0.0142,
                    0.01418,
                    0.01412,
                    0.01403
                  ],
                  "y": [
                    -0.0001,
                    0.0006327,
                    0.001363,
                    0.00209
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "x",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "y",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          },
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "finger 0",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -9.341e-6,
                    -9.326e-6,
                    -9.282e-6,
                    -9.207e-6
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "arc, finger 0",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.0001018,
                    -0.0001014,
                    -0.0001006,
                    -0.00009958
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "solid",
                "name": "finger 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -9.341e-6,
                    -9.326e-6,
                    -9.282e-6,
                    -9.207e-6
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "arc, finger 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00008574,
                    -0.00008588,
                    -0.00008574,
                    -0.00008529
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Travel",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "Offset from the planned line",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 13,
        "panels": [
          {
            "equal": true,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "finger 0",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0333,
                    0.0333,
                    0.0333,
                    0.0333
                  ],
                  "y": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "planned line, finger 0",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.03321,
                    0.03321,
                    0.03321,
                    0.03321
                  ],
                  "y": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "solid",
                "name": "finger 1",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    -0.0333,
                    -0.0333,
                    -0.0333,
                    -0.0333
                  ],
                  "y": [
                    0.0,
                    -0.0001,
                    -0.0002,
                    -0.0003
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "planned line, finger 1",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    -0.03321,
                    -0.03321,
                    -0.03321,
                    -0.03321
                  ],
                  "y": [
                    0.0,
                    -0.0001,
                    -0.0002,
                    -0.0003
                  ]
                }
              },
              {
                "colour": "shared",
                "line": "solid",
                "name": "cap",
                "points": {
                  "x": [
                    0.0142,
                    0.01418,
                    0.01412,
                    0.01403
                  ],
                  "y": [
                    -0.0001,
                    0.0006327,
                    0.001363,
                    0.00209
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "x",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "y",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          },
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "finger 0",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00008874,
                    -0.0000886,
                    -0.00008818,
                    -0.00008747
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "arc, finger 0",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.0001021,
                    -0.0001016,
                    -0.0001009,
                    -0.00009982
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "solid",
                "name": "finger 1",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00008874,
                    -0.0000886,
                    -0.00008818,
                    -0.00008747
                  ]
                }
              },
              {
                "colour": "reference",
                "line": "dashed",
                "name": "arc, finger 1",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00008594,
                    -0.00008609,
                    -0.00008594,
                    -0.00008549
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Travel",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "Offset from the planned line",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 14,
        "panels": [
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00009249,
                    -0.00009206,
                    -0.00009135,
                    -0.00009036
                  ]
                }
              },
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 2",
                "points": {
                  "row": [
                    390,
                    391,
                    392,
                    393
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00003662,
                    -0.00003627,
                    -0.00003583,
                    -0.00003529
                  ]
                }
              },
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 3",
                "points": {
                  "row": [
                    690,
                    691,
                    692,
                    693
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00001334,
                    -0.00001303,
                    -0.0000127,
                    -0.00001235
                  ]
                }
              },
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "stroke 4",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00001334,
                    -0.00001303,
                    -0.0000127,
                    -0.00001235
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Travel",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "R − R₀, finger 0",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          },
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 1",
                "points": {
                  "row": [
                    90,
                    91,
                    92,
                    93
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00007639,
                    -0.00007656,
                    -0.00007645,
                    -0.00007608
                  ]
                }
              },
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 2",
                "points": {
                  "row": [
                    390,
                    391,
                    392,
                    393
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    -0.00002049,
                    -0.00002074,
                    -0.00002091,
                    -0.00002098
                  ]
                }
              },
              {
                "colour": "background",
                "line": "solid",
                "name": "stroke 3",
                "points": {
                  "row": [
                    690,
                    691,
                    692,
                    693
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    2.805e-6,
                    2.514e-6,
                    2.238e-6,
                    1.976e-6
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "solid",
                "name": "stroke 4",
                "points": {
                  "row": [
                    990,
                    991,
                    992,
                    993
                  ],
                  "x": [
                    0.0,
                    0.0001,
                    0.0002,
                    0.0003
                  ],
                  "y": [
                    2.805e-6,
                    2.514e-6,
                    2.238e-6,
                    1.976e-6
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Travel",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            },
            "y": {
              "label": "R − R₀, finger 1",
              "log": false,
              "scale": 1000.0,
              "unit": "mm"
            }
          }
        ]
      }
    ],
    "run": {
      "columns": [
        {
          "name": "time",
          "scale": 1.0,
          "type": "f64",
          "width": 1
        },
        {
          "name": "phase",
          "scale": 1.0,
          "type": "u8",
          "width": 1
        },
        {
          "name": "finger/0/joints",
          "scale": 1.0,
          "type": "f32",
          "width": 3
        },
        {
          "name": "finger/0/forces",
          "scale": 0.0005,
          "type": "i16",
          "width": 123
        },
        {
          "name": "finger/0/flags",
          "scale": 1.0,
          "type": "u8",
          "width": 1
        },
        {
          "name": "finger/0/grasp_force",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        },
        {
          "name": "finger/0/shear_rate",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        }
      ],
      "data": "7N19sOb3edf3e5/0sHpaaXe1u9JqH7Ta1RpKSmcLE5cou00HHGgoOG1C0xGh",
      "phases": [
        "SEARCH",
        "MOVE",
        "RELEASE",
        "RETURN"
      ],
      "rows": 1220,
      "strokes": [
        {
          "end": 300,
          "index": 1,
          "move": [
            90,
            190
          ],
          "start": 0
        },
        {
          "end": 600,
          "index": 2,
          "move": [
            390,
            490
          ],
          "start": 300
        },
        {
          "end": 900,
          "index": 3,
          "move": [
            690,
            790
          ],
          "start": 600
        },
        {
          "end": 1200,
          "index": 4,
          "move": [
            990,
            1090
          ],
          "start": 900
        }
      ]
    },
    "scene": {
      "fingers": [
        {
          "elements": [
            {
              "rotation": [
                -0.5,
                0.5,
                0.5,
                -0.5
              ],
              "tip": [
                -0.018,
                0.0,
                0.0
              ]
            },
            {
              "rotation": [
                -0.3936,
                -0.5874,
                0.5874,
                0.3936
              ],
              "tip": [
                -0.01665,
                -0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                -0.5143,
                -0.3179,
                0.7675,
                0.213
              ],
              "tip": [
                -0.01665,
                -0.004839,
                0.004839
              ]
            },
            {
              "rotation": [
                -0.5567,
                0.0,
                0.8307,
                0.0
              ],
              "tip": [
                -0.01665,
                0.0,
                0.006843
              ]
            }
          ],
          "frame": "finger_0_dome",
          "name": "finger 0",
          "overForce": 1.5,
          "touchForce": 0.1
        },
        {
          "elements": [
            {
              "rotation": [
                0.5,
                0.5,
                0.5,
                0.5
              ],
              "tip": [
                0.018,
                0.0,
                0.0
              ]
            },
            {
              "rotation": [
                0.3936,
                0.5874,
                0.5874,
                0.3936
              ],
              "tip": [
                0.01665,
                0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                0.213,
                0.7675,
                0.3179,
                0.5143
              ],
              "tip": [
                0.01665,
                0.004839,
                -0.004839
              ]
            },
            {
              "rotation": [
                0.0,
                0.8307,
                0.0,
                0.5567
              ],
              "tip": [
                0.01665,
                0.0,
                -0.006843
              ]
            }
          ],
          "frame": "finger_1_dome",
          "name": "finger 1",
          "overForce": 1.5,
          "touchForce": 0.1
        }
      ],
      "frames": [
        {
          "name": "finger_0_base",
          "parent": "world",
          "position": [
            0.1,
            0.0,
            0.1
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 0
          },
          "name": "finger_0_link_1",
          "parent": "finger_0_base",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 1
          },
          "name": "finger_0_link_2",
          "parent": "finger_0_link_1",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.7071,
            0.0,
            0.0,
            0.7071
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 2
          },
          "name": "finger_0_link_3",
          "parent": "finger_0_link_2",
          "position": [
            0.06,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "name": "finger_0_dome",
          "parent": "finger_0_link_3",
          "position": [
            0.055,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "name": "finger_1_base",
          "parent": "world",
          "position": [
            -0.1,
            0.0,
            0.1
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 1,
            "joint": 0
          },
          "name": "finger_1_link_1",
          "parent": "finger_1_base",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        }
      ],
      "home": {
        "centre": [
          0.0,
          0.0,
          0.1
        ],
        "radius": 0.06429
      },
      "shapes": [
        {
          "frame": "finger_0_link_2",
          "position": [
            0.03,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.06,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_0_link_3",
          "position": [
            0.0275,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.055,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_0_dome",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "role": "dome",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "sphere",
            "radius": 0.018
          }
        },
        {
          "frame": "finger_1_link_2",
          "position": [
            0.03,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.06,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_1_link_3",
          "position": [
            0.0275,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.055,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_1_dome",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "role": "dome",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "sphere",
            "radius": 0.018
          }
        },
        {
          "frame": "world",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "role": "fixture",
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ],
          "solid": {
            "kind": "box",
            "size": [
              0.1,
              0.2,
              0.01
            ]
          }
        }
      ]
    },
    "title": "made-up, seed 18446744073709551615",
    "version": 1
  },
  {
    "figures": [
      {
        "columns": 1,
        "number": 1,
        "panels": [
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "success",
                "points": {
                  "high": [
                    39.03,
                    39.03,
                    35.43,
                    98.21
                  ],
                  "low": [
                    0.0,
                    0.0,
                    0.0,
                    59.59
                  ],
                  "x": [
                    0.55,
                    0.67,
                    0.8,
                    0.97
                  ],
                  "y": [
                    0.0,
                    0.0,
                    0.0,
                    90.0
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "friction",
              "log": true,
              "range": [
                0.5,
                1.28
              ],
              "scale": 1.0,
              "unit": ""
            },
            "y": {
              "label": "success",
              "log": false,
              "range": [
                0.0,
                100.0
              ],
              "scale": 1.0,
              "unit": "%"
            }
          },
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "points",
                "name": "success",
                "points": {
                  "command": {
                    "pattern": "feeler run --trial {folder} {trial}",
                    "trial": [
                      20,
                      21,
                      22,
                      23
                    ]
                  },
                  "x": [
                    0.9,
                    0.92,
                    0.94,
                    0.96
                  ],
                  "y": [
                    40.0,
                    41.0,
                    42.0,
                    43.0
                  ]
                }
              },
              {
                "colour": "finger-1",
                "line": "points",
                "name": "failure",
                "points": {
                  "command": {
                    "pattern": "feeler run --trial {folder} {trial}",
                    "trial": [
                      0,
                      1,
                      2,
                      3
                    ]
                  },
                  "x": [
                    0.5,
                    0.52,
                    0.54,
                    0.56
                  ],
                  "y": [
                    20.0,
                    21.0,
                    22.0,
                    23.0
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "friction",
              "log": true,
              "range": [
                0.5,
                1.28
              ],
              "scale": 1.0,
              "unit": ""
            },
            "y": {
              "label": "final torque",
              "log": false,
              "range": [
                18.05,
                60.95
              ],
              "scale": 1.0,
              "unit": "mN·m"
            }
          }
        ]
      },
      {
        "columns": 2,
        "number": 2,
        "panels": [
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "number of trials",
                "points": {
                  "x": [
                    0.0,
                    0.0,
                    1.625,
                    1.625
                  ],
                  "y": [
                    0.0,
                    2.0,
                    2.0,
                    2.0
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "1: peak torque",
              "log": false,
              "range": [
                0.0,
                39.0
              ],
              "scale": 1.0,
              "unit": "mN·m"
            },
            "y": {
              "label": "trials",
              "log": false,
              "range": [
                0.0,
                2.2
              ],
              "scale": 1.0,
              "unit": ""
            }
          }
        ]
      }
    ],
    "title": "Sweep: made-up",
    "version": 1
  },
  {
    "figures": [
      {
        "columns": 1,
        "number": 1,
        "panels": [
          {
            "equal": false,
            "kind": "xy",
            "series": [
              {
                "colour": "finger-0",
                "line": "solid",
                "name": "shear rate",
                "points": {
                  "x": [
                    0.01,
                    2.0,
                    100.0
                  ],
                  "y": [
                    0.0,
                    80.0,
                    100.0
                  ]
                }
              },
              {
                "colour": "finger-0",
                "line": "points",
                "name": "shear rate above 2",
                "points": {
                  "high": [
                    81.0
                  ],
                  "label": [
                    "precision 90.0 [89.0, 91.0] %"
                  ],
                  "low": [
                    79.0
                  ],
                  "x": [
                    2.0
                  ],
                  "y": [
                    80.0
                  ]
                }
              }
            ],
            "thresholds": [],
            "x": {
              "label": "false alarms",
              "log": true,
              "range": [
                0.01,
                100.0
              ],
              "scale": 1.0,
              "unit": "%"
            },
            "y": {
              "label": "slips detected",
              "log": false,
              "range": [
                0.0,
                100.0
              ],
              "scale": 1.0,
              "unit": "%"
            }
          }
        ]
      }
    ],
    "title": "Slip detectors: made-up",
    "version": 1
  },
  {
    "figures": [
      {
        "columns": 1,
        "number": 1,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/grasp_force"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/grasp_force"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "grasp threshold",
                "value": 1.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Grasp force",
              "log": false,
              "scale": 1.0,
              "unit": "N"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 2,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "finger-0",
                "column": {
                  "index": 0,
                  "name": "finger/0/shear_rate"
                },
                "line": "solid",
                "name": "finger 0"
              },
              {
                "colour": "finger-1",
                "column": {
                  "index": 0,
                  "name": "finger/1/shear_rate"
                },
                "line": "solid",
                "name": "finger 1"
              }
            ],
            "thresholds": [
              {
                "name": "slip threshold",
                "value": 3.0
              }
            ],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Shear rate",
              "log": false,
              "scale": 1.0,
              "unit": "N/s"
            }
          }
        ]
      },
      {
        "columns": 1,
        "number": 3,
        "panels": [
          {
            "equal": false,
            "kind": "time",
            "series": [
              {
                "colour": "shared",
                "column": {
                  "index": 0,
                  "name": "torque"
                },
                "line": "solid",
                "name": "torque"
              }
            ],
            "thresholds": [],
            "x": {
              "label": "Time",
              "log": false,
              "scale": 1.0,
              "unit": "s"
            },
            "y": {
              "label": "Torque",
              "log": false,
              "scale": 1000.0,
              "unit": "mN·m"
            }
          }
        ]
      }
    ],
    "live": {
      "felt": true,
      "keep": 2000,
      "orders": true,
      "socket": "/token/live"
    },
    "run": {
      "columns": [
        {
          "name": "time",
          "scale": 1.0,
          "type": "f64",
          "width": 1
        },
        {
          "name": "phase",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        },
        {
          "name": "finger/0/joints",
          "scale": 1.0,
          "type": "f32",
          "width": 3
        },
        {
          "name": "finger/0/forces",
          "scale": 1.0,
          "type": "f32",
          "width": 123
        },
        {
          "name": "finger/0/flags",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        },
        {
          "name": "finger/0/grasp_force",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        },
        {
          "name": "finger/0/shear_rate",
          "scale": 1.0,
          "type": "f32",
          "width": 1
        }
      ],
      "data": "",
      "phases": [
        "SEARCH",
        "MOVE",
        "RELEASE",
        "RETURN"
      ],
      "rows": 0,
      "strokes": []
    },
    "scene": {
      "fingers": [
        {
          "elements": [
            {
              "rotation": [
                -0.5,
                0.5,
                0.5,
                -0.5
              ],
              "tip": [
                -0.018,
                0.0,
                0.0
              ]
            },
            {
              "rotation": [
                -0.3936,
                -0.5874,
                0.5874,
                0.3936
              ],
              "tip": [
                -0.01665,
                -0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                -0.5143,
                -0.3179,
                0.7675,
                0.213
              ],
              "tip": [
                -0.01665,
                -0.004839,
                0.004839
              ]
            },
            {
              "rotation": [
                -0.5567,
                0.0,
                0.8307,
                0.0
              ],
              "tip": [
                -0.01665,
                0.0,
                0.006843
              ]
            },
            {
              "rotation": [
                -0.5143,
                0.3179,
                0.7675,
                -0.213
              ],
              "tip": [
                -0.01665,
                0.004839,
                0.004839
              ]
            },
            {
              "rotation": [
                -0.3936,
                0.5874,
                0.5874,
                -0.3936
              ],
              "tip": [
                -0.01665,
                0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                -0.213,
                0.7675,
                0.3179,
                -0.5143
              ],
              "tip": [
                -0.01665,
                0.004839,
                -0.004839
              ]
            }
          ],
          "frame": "finger_0_dome",
          "name": "finger 0",
          "overForce": 1.5,
          "touchForce": 0.1
        },
        {
          "elements": [
            {
              "rotation": [
                0.5,
                0.5,
                0.5,
                0.5
              ],
              "tip": [
                0.018,
                0.0,
                0.0
              ]
            },
            {
              "rotation": [
                0.3936,
                0.5874,
                0.5874,
                0.3936
              ],
              "tip": [
                0.01665,
                0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                0.213,
                0.7675,
                0.3179,
                0.5143
              ],
              "tip": [
                0.01665,
                0.004839,
                -0.004839
              ]
            },
            {
              "rotation": [
                0.0,
                0.8307,
                0.0,
                0.5567
              ],
              "tip": [
                0.01665,
                0.0,
                -0.006843
              ]
            },
            {
              "rotation": [
                -0.213,
                0.7675,
                -0.3179,
                0.5143
              ],
              "tip": [
                0.01665,
                -0.004839,
                -0.004839
              ]
            },
            {
              "rotation": [
                -0.3936,
                0.5874,
                -0.5874,
                0.3936
              ],
              "tip": [
                0.01665,
                -0.006843,
                0.0
              ]
            },
            {
              "rotation": [
                0.5143,
                -0.3179,
                0.7675,
                -0.213
              ],
              "tip": [
                0.01665,
                -0.004839,
                0.004839
              ]
            }
          ],
          "frame": "finger_1_dome",
          "name": "finger 1",
          "overForce": 1.5,
          "touchForce": 0.1
        }
      ],
      "frames": [
        {
          "name": "finger_0_base",
          "parent": "world",
          "position": [
            0.1,
            0.0,
            0.1
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 0
          },
          "name": "finger_0_link_1",
          "parent": "finger_0_base",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 1
          },
          "name": "finger_0_link_2",
          "parent": "finger_0_link_1",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.7071,
            0.0,
            0.0,
            0.7071
          ]
        },
        {
          "joint": {
            "finger": 0,
            "joint": 2
          },
          "name": "finger_0_link_3",
          "parent": "finger_0_link_2",
          "position": [
            0.06,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "name": "finger_0_dome",
          "parent": "finger_0_link_3",
          "position": [
            0.055,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "name": "finger_1_base",
          "parent": "world",
          "position": [
            -0.1,
            0.0,
            0.1
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        },
        {
          "joint": {
            "finger": 1,
            "joint": 0
          },
          "name": "finger_1_link_1",
          "parent": "finger_1_base",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "rotation": [
            0.0,
            0.0,
            0.0,
            1.0
          ]
        }
      ],
      "home": {
        "centre": [
          0.0,
          0.0,
          0.05
        ],
        "radius": 0.0516
      },
      "shapes": [
        {
          "frame": "finger_0_link_2",
          "position": [
            0.03,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.06,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_0_link_3",
          "position": [
            0.0275,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.055,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_0_dome",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "role": "dome",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "sphere",
            "radius": 0.018
          }
        },
        {
          "frame": "finger_1_link_2",
          "position": [
            0.03,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.06,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_1_link_3",
          "position": [
            0.0275,
            0.0,
            0.0
          ],
          "role": "link",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "cylinder",
            "length": 0.055,
            "radius": 0.0054
          }
        },
        {
          "frame": "finger_1_dome",
          "position": [
            0.0,
            0.0,
            0.0
          ],
          "role": "dome",
          "rotation": [
            0.0,
            0.7071,
            0.0,
            0.7071
          ],
          "solid": {
            "kind": "sphere",
            "radius": 0.018
          }
        }
      ]
    },
    "title": "made-up",
    "version": 1
  }
];
