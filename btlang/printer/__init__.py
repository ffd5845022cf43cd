"""The printer, which writes syntax trees and leaves as English."""
