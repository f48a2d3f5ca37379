!> How deep contacts have been, and which stiffness would have kept them shallow.
module overlap_report
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  use solids_statistics, only: statistics_t, deep
  use text, only: brief
  implicit none
  private
  public :: overlap_report_t, stiffness_factor, modulus_factor

  !> Beyond this share of the smaller radius an overlap is no longer that of spheres: contact area, packing and the
  !> forces on the neighbours are wrong.
  real(wp), parameter :: tolerable = deep(size(deep))

  type :: overlap_report_t
    real(wp) :: largest = 0.0_wp             !< over the smaller radius [-]
    real(wp) :: beyond(size(deep)) = 0.0_wp  !< largest share of contacts so deep [-]
  contains
    procedure :: enter
    procedure :: print => print_report
  end type overlap_report_t

contains

  !> Note one record.
  pure subroutine enter(self, statistics)
    class(overlap_report_t), intent(inout) :: self
    type(statistics_t), intent(in) :: statistics

    self%largest = max(self%largest, statistics%max_overlap)
    self%beyond = max(self%beyond, statistics%beyond)
  end subroutine enter

  !> By how much a linear spring must be stiffer for a collision that overlaps by `overlap` to overlap by
  !> `wanted`: v sqrt(m/k) is the overlap at speed v. Under a static load, which goes as 1/k, less would do.
  elemental function stiffness_factor(overlap, wanted) result(factor)
    real(wp), intent(in) :: overlap, wanted  !< [-]
    real(wp) :: factor

    factor = (overlap/wanted)**2
  end function stiffness_factor

  !> The same of Young's modulus: Hertz's overlap goes as E^(-2/5).
  elemental function modulus_factor(overlap, wanted) result(factor)
    real(wp), intent(in) :: overlap, wanted  !< [-]
    real(wp) :: factor

    factor = (overlap/wanted)**2.5_wp
  end function modulus_factor

  subroutine print_report(self, contact, unit)
    class(overlap_report_t), intent(in) :: self
    type(contact_settings_t), intent(in) :: contact
    integer, intent(in) :: unit

    real(wp) :: factor

    write (unit, '(2x,a,t18,a)') 'overlap', 'at most '//brief(self%largest)//' of the radius; beyond 0.01, 0.05, 0.1 at most ' &
      //brief(self%beyond(1))//', '//brief(self%beyond(2))//', '//brief(self%beyond(3))//' of all contacts'
    if (self%largest <= tolerable) return
    if (contact%law == 'hertz') then
      factor = modulus_factor(self%largest, tolerable)
    else
      factor = stiffness_factor(self%largest, tolerable)
    end if
    write (unit, '(2x,a,t18,a)') '', 'to stay within '//brief(tolerable)//' '//advice(contact, factor)//': ' &
      //brief(self%largest/tolerable)//' times as many solids steps'
  end subroutine print_report

  !> What to write into the case to make contacts stiffer by a factor.
  pure function advice(contact, factor) result(words)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: factor
    character(len=:), allocatable :: words

    if (allocated(contact%materials)) then
      words = 'make all '//trim(merge('values of youngs_modulus', 'values of stiffness     ', contact%law == 'hertz')) &
              //' '//brief(factor)//' times as large'
    else if (contact%law == 'hertz') then
      words = 'give &contact youngs_modulus = '//brief(contact%youngs_modulus*factor)//' Pa instead of ' &
              //brief(contact%youngs_modulus)
    else
      words = 'give &contact stiffness = '//brief(contact%stiffness*factor)//' N/m instead of '//brief(contact%stiffness)
    end if
  end function advice

end module overlap_report
