!> What every verification program prints: values for the rows of checks.csv, and points for the pictures.
module report
  use kinds, only: wp
  implicit none
  private
  public :: check_value, point

contains

  !> One line 'check NAME COMPUTED EXPECTED'. The tolerance stands in checks.csv alone.
  subroutine check_value(name, computed, expected)
    character(len=*), intent(in) :: name  !< of the row
    real(wp), intent(in) :: computed, expected

    print '(3a,es23.15,1x,es23.15)', 'check ', name, ' ', computed, expected
  end subroutine check_value

  !> One line 'point CURVE X COMPUTED EXPECTED'.
  subroutine point(curve, x, computed, expected)
    character(len=*), intent(in) :: curve
    real(wp), intent(in) :: x, computed, expected

    print '(3a,3(es15.7,1x))', 'point ', curve, ' ', x, computed, expected
  end subroutine point

end module report
