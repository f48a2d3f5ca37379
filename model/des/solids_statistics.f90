!> What is told about the parcels at report time, over all ranks.
module solids_statistics
  use contact_list, only: contact_list_t
  use kinds, only: wp, i8
  use parcels, only: parcels_t, mass_row
  use solids, only: solids_t
  implicit none
  private
  public :: statistics_t, find_statistics, deep

  real(wp), parameter :: deep(3) = [0.01_wp, 0.05_wp, 0.1_wp]  !< overlaps over the smaller radius that are counted [-]

  type :: statistics_t
    real(wp) :: max_overlap = 0.0_wp     !< largest overlap over the smaller radius, walls included [-]
    real(wp) :: mean_overlap = 0.0_wp    !< mean over all contacts of parcels, of the same ratio [-]
    real(wp) :: beyond(size(deep)) = 0.0_wp  !< shares of all contacts, walls included, that are so deep [-]
    real(wp) :: kinetic_energy = 0.0_wp  !< of parcels, translation and rotation [J]
    integer(i8) :: contacts = 0          !< between parcels
    integer(i8) :: wall_contacts = 0
    integer(i8) :: parcels = 0
    real(wp) :: mass = 0.0_wp            !< of parcels [kg]
    integer(i8) :: left = 0              !< parcels gone through open faces since the start
    real(wp) :: mass_left = 0.0_wp       !< [kg]
    integer(i8) :: lost = 0              !< expected less found: must be 0
    integer(i8) :: rebuilds = 0          !< lists made since the start
  end type statistics_t

contains

  !> Look at all parcels and contacts as they are now. All ranks take part.
  function find_statistics(solids) result(s)
    type(solids_t), intent(in) :: solids
    type(statistics_t) :: s

    real(wp) :: sums(6 + size(deep)), largest, mass

    sums = 0.0_wp
    call add_pairs(solids%parcels, solids%list, sums(1), sums(2), sums(7:), largest)
    call add_walls(solids, sums(3), sums(7:), largest)
    call add_parcels(solids%parcels, sums(4), mass)
    sums(5) = mass
    sums(6) = solids%parcels%n
    sums = solids%comm%sum(sums)
    s%max_overlap = solids%comm%max(largest)
    s%mean_overlap = sums(1)/max(sums(2), 1.0_wp)
    s%beyond = sums(7:)/max(sums(2) + sums(3), 1.0_wp)
    s%contacts = nint(sums(2), i8)
    s%wall_contacts = nint(sums(3), i8)
    s%kinetic_energy = sums(4)
    s%mass = sums(5)
    s%parcels = nint(sums(6), i8)
    s%left = solids%left
    s%mass_left = solids%mass_left
    s%lost = solids%added - solids%left - s%parcels
    s%rebuilds = solids%rebuilds
  end function find_statistics

  !> Overlaps of listed pairs; a pair with a ghost is seen from both sides and counts half on each.
  pure subroutine add_pairs(parcels, list, overlaps, contacts, beyond, largest)
    type(parcels_t), intent(in) :: parcels
    type(contact_list_t), intent(in) :: list
    real(wp), intent(out) :: overlaps   !< sum of overlap over the smaller radius [-]
    real(wp), intent(out) :: contacts
    real(wp), intent(inout) :: beyond(:)  !< contacts so deep, see `deep`
    real(wp), intent(out) :: largest    !< [-]

    real(wp) :: overlap, share, square
    integer :: i, j, k

    overlaps = 0.0_wp
    contacts = 0.0_wp
    largest = 0.0_wp
    if (parcels%n == 0) return
    do i = 1, list%rows
      do k = list%first(i), list%first(i + 1) - 1
        j = list%partner(k)
        associate (a => parcels%state(1:4, i), b => parcels%state(1:4, j))
          square = sum((a(1:3) - b(1:3))**2)
          if (square >= (a(4) + b(4))**2) cycle
          overlap = (a(4) + b(4) - sqrt(square))/min(a(4), b(4))
        end associate
        share = merge(1.0_wp, 0.5_wp, j <= parcels%n)
        overlaps = overlaps + share*overlap
        contacts = contacts + share
        where (overlap > deep) beyond = beyond + share
        largest = max(largest, overlap)
      end do
    end do
  end subroutine add_pairs

  pure subroutine add_walls(solids, contacts, beyond, largest)
    type(solids_t), intent(in) :: solids
    real(wp), intent(out) :: contacts
    real(wp), intent(inout) :: beyond(:)  !< contacts so deep, see `deep`
    real(wp), intent(inout) :: largest    !< [-]

    real(wp) :: overlap
    integer :: w, run

    contacts = 0.0_wp
    do w = 1, solids%walls%kind_end(3)
      associate (s => solids%parcels%state(1:4, solids%walls%parcel(w)))
        overlap = 1 - solids%chamber%distance(solids%walls%face(w), s(1:3))/s(4)
        if (overlap <= 0.0_wp) cycle
        contacts = contacts + 1
        where (overlap > deep) beyond = beyond + 1
        largest = max(largest, overlap)
      end associate
    end do
    do run = 1, solids%walls%runs
      call add_run(solids, solids%walls%run_range(run), contacts, beyond, largest)
    end do
  end subroutine add_walls

  !> The contacts of a parcel with a mesh.
  pure subroutine add_run(solids, range, contacts, beyond, largest)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: range(2)  !< entries
    real(wp), intent(inout) :: contacts, beyond(:), largest

    real(wp) :: gap(4, range(2) - range(1) + 1), overlap
    integer :: chosen(size(gap, 2)), n, c

    call solids%walls%look_at_run(solids%chamber, solids%parcels, range, gap, chosen, n)
    do c = 1, n
      overlap = 1 - gap(4, chosen(c))/solids%parcels%state(4, solids%walls%parcel(range(1)))
      contacts = contacts + 1
      where (overlap > deep) beyond = beyond + 1
      largest = max(largest, overlap)
    end do
  end subroutine add_run

  !> Kinetic energy, with (1/2) I omega^2 = (1/5) m (r omega)^2, and mass.
  pure subroutine add_parcels(parcels, energy, mass)
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(out) :: energy  !< [J]
    real(wp), intent(out) :: mass    !< [kg]

    integer :: i

    energy = 0.0_wp
    mass = 0.0_wp
    do i = 1, parcels%n
      associate (m => 1/parcels%state(mass_row, i))
        mass = mass + m
        energy = energy + 0.5_wp*m*sum(parcels%state(5:7, i)**2)
        if (parcels%rotation) energy = energy + 0.2_wp*m*sum(parcels%state(9:11, i)**2)
      end associate
    end do
  end subroutine add_parcels

end module solids_statistics
