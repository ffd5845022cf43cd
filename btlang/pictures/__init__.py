"""Pictures of trees and of runs. Matplotlib is an extra, and only imported when a picture is drawn."""
