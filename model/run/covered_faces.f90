!> Which faces of the domain a boundary covers as a whole: a material is that of such faces.
module covered_faces
  use boundary_settings, only: boundary_settings_t
  use domain_settings, only: domain_settings_t
  implicit none
  private
  public :: faces_covered

contains

  pure function faces_covered(domain, boundary) result(covered)
    type(domain_settings_t), intent(in) :: domain
    type(boundary_settings_t), intent(in) :: boundary
    logical :: covered(2, 3)  !< low and high face of each direction

    logical :: spans(3)
    integer :: a

    do a = 1, 3
      spans = boundary%lower <= domain%lower .and. boundary%upper >= domain%upper
      spans(a) = .true.
      covered(1, a) = all(spans) .and. boundary%lower(a) <= domain%lower(a)
      covered(2, a) = all(spans) .and. boundary%upper(a) >= domain%upper(a)
    end do
  end function faces_covered

end module covered_faces
