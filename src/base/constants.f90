!> Constants, and the mark of a number nobody has set.
module constants
  use kinds, only: wp
  implicit none
  private
  public :: pi, gas_constant, unset, is_set

  real(wp), parameter :: pi = acos(-1.0_wp)
  real(wp), parameter :: gas_constant = 8.31446261815324_wp  !< molar, exact since the SI of 2019 [J/(mol K)]
  real(wp), parameter :: unset = -huge(1.0_wp)  !< default of a real key that has none

contains

  !> Whether a real key was given.
  elemental function is_set(x)
    real(wp), intent(in) :: x
    logical :: is_set

    is_set = x > unset
  end function is_set

end module constants
