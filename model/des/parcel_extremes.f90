!> The largest parcel, and the smallest and lightest of each material.
module parcel_extremes
  use communicator, only: communicator_t
  use contact_laws, only: contact_laws_t
  use kinds, only: wp
  use parcels, only: parcels_t, radius_row, mass_row
  implicit none
  private
  public :: widen_extremes

contains

  !> Bring them up to date; those of parcels that are gone stay. All ranks take part.
  subroutine widen_extremes(comm, laws, parcels, largest, smallest, lightest)
    type(communicator_t), intent(in) :: comm
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(inout) :: largest                     !< radius; 0 while there are none [m]
    real(wp), intent(inout) :: smallest(0:), lightest(0:)  !< (0:M) radius [m] and mass [kg]; huge while there are none

    real(wp) :: extremes(1 + 2*size(lightest))
    integer :: i, m, n

    n = size(lightest)
    extremes = [largest, -smallest, -lightest]
    do i = 1, parcels%n
      m = 2
      if (n > 1) m = 2 + laws%material(parcels%powder(i))
      extremes(1) = max(extremes(1), parcels%state(radius_row, i))
      extremes(m) = max(extremes(m), -parcels%state(radius_row, i))
      extremes(m + n) = max(extremes(m + n), -1/parcels%state(mass_row, i))
    end do
    extremes = comm%max(extremes)
    largest = extremes(1)
    smallest = -extremes(2:n + 1)
    lightest = -extremes(n + 2:)
  end subroutine widen_extremes

end module parcel_extremes
