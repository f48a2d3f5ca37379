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
  subroutine widen_extremes(comm, laws, parcels, largest, ratio, smallest, lightest)
    type(communicator_t), intent(in) :: comm
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(inout) :: largest                     !< radius; 0 while there are none [m]
    real(wp), intent(inout) :: ratio                       !< largest of radius over mass of a parcel [m/kg]
    real(wp), intent(inout) :: smallest(0:), lightest(0:)  !< (0:M) radius [m] and mass [kg]; huge while there are none

    real(wp) :: extremes(2 + 2*size(lightest))
    integer :: i, m, n

    n = size(lightest)
    extremes = [largest, ratio, -smallest, -lightest]
    do i = 1, parcels%n
      m = 3
      if (n > 1) m = 3 + laws%material(parcels%powder(i))
      extremes(1) = max(extremes(1), parcels%state(radius_row, i))
      extremes(2) = max(extremes(2), parcels%state(radius_row, i)*parcels%state(mass_row, i))
      extremes(m) = max(extremes(m), -parcels%state(radius_row, i))
      extremes(m + n) = max(extremes(m + n), -1/parcels%state(mass_row, i))
    end do
    extremes = comm%max(extremes)
    largest = extremes(1)
    ratio = extremes(2)
    smallest = -extremes(3:n + 2)
    lightest = -extremes(n + 3:)
  end subroutine widen_extremes

end module parcel_extremes
